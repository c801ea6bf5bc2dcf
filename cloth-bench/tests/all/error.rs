//! Lengths of messages.

use cloth_bench::error::BenchError;

#[test]
fn what_a_message_repeats_has_a_bounded_length() {
    let told = |message: &str| BenchError::usage(message).to_string();
    let [words, word] = ["ä b ".repeat(300), "ä".repeat(300)];
    let message = told(&format!("{word} is `{words}` (known: {words})"));
    assert_eq!(message.chars().count(), 240 + 5 + 120 + 10 + 1200 + 1);
    let short = "n is `x`, but it has to be a whole number";
    assert_eq!(told(short), short);
    // Two thirds of what is left are the beginning.
    let path: String = ('a'..='z').cycle().take(241).collect();
    assert_eq!(told(&path), format!("{}…{}", &path[..159], &path[161..]));
    assert_eq!(told(&path[..240]), path[..240]);
}
