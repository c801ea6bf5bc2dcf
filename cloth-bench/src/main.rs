//! The program: `cloth-bench study | run | merge | locking | untangle | ccd | law | list`.

fn main() -> std::process::ExitCode {
    cloth_bench::main_with(&[])
}
