//! Cases shared among several runs.

use cloth_bench::journal::Shard;

/// Every case falls to exactly one shard, and the shards are about as large.
#[test]
fn shards_cut_the_cases_evenly() {
    let names: Vec<String> = (0..1000).map(|i| format!("case {i}")).collect();
    for count in [1_u64, 2, 3, 8] {
        let shard = |number| format!("{number}/{count}").parse().unwrap();
        let shards: Vec<Shard> = (1..=count).map(shard).collect();
        let sizes = shards.iter().map(|shard| {
            names
                .iter()
                .filter(|name| shard.includes("study", name))
                .count()
        });
        let sizes: Vec<usize> = sizes.collect();
        assert_eq!(sizes.iter().sum::<usize>(), 1000);
        let mean = 1000 / count as usize;
        assert!(sizes.iter().all(|&n| n.abs_diff(mean) < 70), "{sizes:?}");
    }
    assert_eq!("2/4".parse::<Shard>().unwrap().to_string(), "2/4");
    for text in ["0/2", "3/2", "1", "a/b", "1/0", ""] {
        assert!(text.parse::<Shard>().is_err(), "{text}");
    }
}
