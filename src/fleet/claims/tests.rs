use super::*;

fn worker(name: &str) -> Worker {
    Worker(name.to_owned())
}

fn enter(dir: &Path, name: &str) -> Claims {
    Claims::enter(dir, &worker(name)).expect("a worker")
}

fn set(path: &Path, before: Duration) {
    let file = File::options().write(true).open(path).expect("a file");
    file.set_modified(SystemTime::now() - before).expect("a time");
}

#[test]
fn one_of_many_takes_each() {
    let dir = tempfile::tempdir().expect("a folder");
    let all: Vec<Claims> = (0..8).map(|i| enter(dir.path(), &format!("w{i}"))).collect();
    let taken = std::sync::Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for claims in &all {
            scope.spawn(|| {
                for what in 0..100 {
                    if claims.take(&what.to_string()).expect("a claim") {
                        taken.lock().expect("no panic").push(what);
                    }
                }
            });
        }
    });
    let mut taken = taken.into_inner().expect("no panic");
    taken.sort_unstable();
    assert_eq!(taken, (0..100).collect::<Vec<_>>());
}

#[test]
fn what_a_dead_worker_had_is_anybodys_and_what_a_living_one_has_is_not() {
    let dir = tempfile::tempdir().expect("a folder");
    let folder = parts::folder(dir.path());
    let [dead, living] = ["dead", "living"].map(|name| enter(dir.path(), name));
    assert!(dead.take("7").expect("a claim") && !living.take("7").expect("no claim"));
    assert_eq!(owner(dir.path(), "7").as_deref(), Some("dead"));
    // Killed: nobody stops the thread, but its next sign is seconds off.
    set(&folder.join("dead.alive"), STALE - SIGN);
    assert!(!living.take("7").expect("no claim"));
    set(&folder.join("dead.alive"), STALE + SIGN);
    assert!(living.take("7").expect("a claim") && !dead.take("7").expect("no claim"));
    assert_eq!(owner(dir.path(), "7").as_deref(), Some("living"));
    // The clock of the file system alone counts: both an hour ago are as good as both now.
    set(&folder.join("dead.alive"), Duration::from_secs(3600));
    set(&folder.join("living.alive"), Duration::from_secs(3600));
    assert!(!dead.take("7").expect("no claim"));
}

#[test]
fn one_that_leaves_or_ends_gives_up_what_it_has() {
    let dir = tempfile::tempdir().expect("a folder");
    let stays = enter(dir.path(), "stays");
    for leaves in [true, false] {
        let goes = enter(dir.path(), "goes");
        assert!(goes.take("1").expect("a claim") && !stays.take("1").expect("no claim"));
        if leaves {
            worker("goes").leave(dir.path());
        } else {
            drop(goes);
        }
        assert!(stays.take("1").expect("a claim"));
        stays.release("1");
    }
    drop(stays);
    assert!(!parts::folder(dir.path()).exists());
}

#[test]
fn a_claim_without_a_name_is_left_to_its_owner_for_a_while() {
    let dir = tempfile::tempdir().expect("a folder");
    let claims = enter(dir.path(), "one");
    let path = parts::folder(dir.path()).join("3.claim");
    fs::write(&path, "").expect("a claim");
    assert!(!claims.take("3").expect("no claim"));
    set(&path, STALE + SIGN);
    assert!(claims.take("3").expect("a claim"));
}

#[test]
fn no_two_workers_have_the_same_name() {
    assert_ne!(Worker::new().0, Worker::new().0);
}
