use super::permuted;

#[test]
fn every_stratum_is_hit_once() {
    for count in [1, 2, 3, 10, 100, 1000, 4097] {
        let mut hit: Vec<u64> = (0..count).map(|i| permuted(i, count, 7 * count)).collect();
        hit.sort_unstable();
        assert!(hit.iter().copied().eq(0..count), "{count}");
    }
}
