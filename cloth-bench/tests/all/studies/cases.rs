//! Cases of a study, one after the other and side by side.

use cloth_bench::error::BenchError;
use cloth_bench::journal::Journal;
use cloth_bench::journal::RunHeader;
use cloth_bench::studies::{Cases, Progress, Share};
use std::sync::Mutex;

fn heading() -> RunHeader {
    RunHeader {
        studies: vec!["squares".into()],
        quick: true,
        facts: Vec::new(),
    }
}

/// The journal has no word for a number that is none: said at once, of the case.
#[test]
fn a_result_that_is_no_number_is_an_error_of_its_case() {
    let mut progress = |_: Progress<'_>| {};
    let mut cases = Cases::new("squares", None, Share::All, &mut progress, None);
    let error = cases.case("root of -1", || Ok(f64::NAN)).unwrap_err();
    let said = error.to_string();
    assert!(
        said.contains("case `root of -1` of study `squares`"),
        "{said}"
    );
    let every = cases.side_by_side(&[-1.0], |x| format!("{x}"), |x: &f64| Ok(x.sqrt()));
    assert!(
        every[0]
            .as_ref()
            .unwrap_err()
            .to_string()
            .contains("case `-1`")
    );
}

/// Results come in the order of the items, whichever ended first; what is finished is not run again, and what falls
/// to another run is left out.
#[test]
fn cases_side_by_side_are_those_one_after_the_other() {
    let folder = std::env::temp_dir().join(format!("cloth-cases-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    let items: Vec<u64> = (0..40).collect();
    let name = |item: &u64| format!("{item} squared");
    let made = Mutex::new(Vec::new());
    let work = |&item: &u64| {
        // The later the sooner done.
        std::thread::sleep(std::time::Duration::from_micros(50 * (40 - item)));
        made.lock().unwrap().push(item);
        if item == 7 {
            return Err(BenchError::Failed("seven".into()));
        }
        Ok(item * item)
    };
    let run = |journal: &mut Journal, share| {
        let mut seen = 0;
        let mut progress = |_: Progress<'_>| seen += 1;
        let mut cases = Cases::new("squares", Some(journal), share, &mut progress, None);
        let every = cases.side_by_side(&items, name, work);
        let left_out = cases.left_out().len();
        let made = std::mem::take(&mut *made.lock().unwrap());
        let every: Vec<Result<u64, String>> = every
            .into_iter()
            .map(|found| found.map_err(|error| error.to_string()))
            .collect();
        (every, made.len(), left_out, seen)
    };
    let expected: Vec<Result<u64, String>> = items
        .iter()
        .map(|&item| match item {
            7 => Err("seven".to_owned()),
            _ => Ok(item * item),
        })
        .collect();
    let mut journal = Journal::begin(&folder, heading()).unwrap();
    let shard = Share::One("1/2".parse().unwrap());
    let (_, made_first, left_out, _) = run(&mut journal, shard);
    assert!(made_first > 0 && made_first + left_out == 40);
    assert_eq!(journal.len(), made_first);
    let (every, made, none, seen) = run(&mut journal, Share::All);
    assert_eq!(
        (every, made, none, seen),
        (expected.clone(), left_out, 0, 40)
    );
    drop(journal);
    let mut journal = Journal::resume(&folder, heading()).unwrap();
    let (every, made, none, _) = run(&mut journal, Share::Nothing);
    assert_eq!((every, made, none), (expected, 0, 0));
    std::fs::remove_dir_all(&folder).unwrap();
}
