//! `--set NAME=VALUE`: parameters in their declared units, or with a unit.

use ntg_interp::Interpreted;

/// Sets a parameter, all members of an array (`a=1,2,3`), or one member (`a[2]=1`).
pub(crate) fn set(problem: &mut Interpreted, assignment: &str) -> Result<(), String> {
    let say = |message: String| format!("--set {assignment}: {message}");
    let (target, text) = assignment
        .split_once('=')
        .filter(|(_, text)| !text.trim().is_empty())
        .ok_or_else(|| say("write NAME=VALUE, such as `v_max=0.2` or `v_max=\"200 [m/s]\"`".to_owned()))?;
    problem.assign(target, text).map_err(say)
}
