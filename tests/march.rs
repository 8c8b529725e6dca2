mod gears;
use gears::{gear, gear_a_dash, let_go, wedge};
use trainsafe::law::Law;
use trainsafe::march::{Ask, solve};

#[test]
fn figure_4() {
    let linear = Law::Elastic { draft_n_per_m: 1.0, buff_n_per_m: 1.0, slack_m: 0.0 };
    let ask = Ask { audit: true, ..Ask::default() };
    for law in [
        linear,
        wedge(1.0, 18.0, 0.0, 0.0, 1e3),
        wedge(1.0, 18.0, 0.5, 0.0, 1e3),
        wedge(1.0, 18.0, 0.5, 0.5, 1e3),
        wedge(1.0, 18.0, 0.0, 0.5, 1e3),
        wedge(1.0, 18.0, 0.87, 2., 1e3),
    ] {
        let clock = std::time::Instant::now();
        let free = matches!(law, Law::Elastic { .. });
        let out = solve(&let_go(50, 1.0, &law, &[1.0], if free { 60.0 } else { 400.0 }), &ask);
        let low = out.extremes.iter().map(|e| e.buff).min_by(|a, b| a.force_n.total_cmp(&b.force_n)).unwrap();
        let high = out.extremes.iter().map(|e| e.draft).max_by(|a, b| a.force_n.total_cmp(&b.force_n)).unwrap();
        println!(
            "{:.14} at {:.13} draft {:.14} at {} | ev {} st {} {:?} {:?}",
            low.force_n,
            low.time_s,
            high.force_n,
            high.time_s,
            out.events,
            out.steps,
            out.energy.unwrap(),
            clock.elapsed()
        );
    }
}

#[test]
fn cars_105() {
    for (slack, want) in [(0.0, 0.86782652), (0.01, 0.85415364), (0.025, 0.65792147)] {
        let law = gear(2e8, slack, gear_a_dash());
        let clock = std::time::Instant::now();
        let out = solve(&let_go(105, 130e3, &law, &[6e5], 40.0), &Ask::default());
        let low = out.extremes.iter().map(|e| e.buff).min_by(|a, b| a.force_n.total_cmp(&b.force_n)).unwrap();
        println!(
            "{:.12} want {want} at {} events {} steps {} {:?}",
            low.force_n / 6e5,
            low.time_s,
            out.events,
            out.steps,
            clock.elapsed()
        );
    }
}
