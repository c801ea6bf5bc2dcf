//! Lines of the journal and their checksums.

use cloth_bench::journal::line::{read, write};
use serde_json::{Value, json};

#[test]
fn any_changed_byte_is_noticed() {
    let value = json!({"case": "k = 200 N/m", "found": {"error": 0.1}, "none": null});
    let line = write(&value).unwrap();
    let whole: Value = serde_json::from_str(&line).unwrap();
    assert_eq!(whole["case"], value["case"], "every line is JSON");
    let line = line.trim_end().as_bytes();
    assert_eq!(read(line), Ok(value));
    for place in 0..line.len() {
        for change in 1..=255 {
            let mut changed = line.to_vec();
            changed[place] ^= change;
            assert!(read::<Value>(&changed).is_err(), "byte {place} ^ {change}");
        }
        assert!(read::<Value>(&line[..place]).is_err());
    }
}
