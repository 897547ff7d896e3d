//! The files of a written crate.

use std::path::{Component, Path, PathBuf};

use super::loops::Loops;
use super::source::Dependency;

/// Everything that a crate is made of.
pub(super) struct Crate<'a> {
    pub(super) name: &'a str,
    /// The problem's name in the spec.
    pub(super) problem: &'a str,
    /// The spec's file name and text.
    pub(super) spec: (&'a str, &'a str),
    /// What the spec has loaded, by the paths that it gives.
    pub(super) loaded: &'a [(String, String)],
    /// The files that were read.
    pub(super) read: &'a [PathBuf],
    pub(super) header: &'a str,
    pub(super) dependency: &'a Dependency,
    pub(super) loops: &'a Loops<'a>,
}

/// Templates with the places where they go; `@NAME@` in a place is the crate's name.
const TEMPLATES: [(&str, &str); 12] = [
    ("Cargo.toml", include_str!("template/manifest.toml")),
    ("README.md", include_str!("template/README.md")),
    ("src/lib.rs", include_str!("template/lib.rs.in")),
    ("CMakeLists.txt", include_str!("template/CMakeLists.txt")),
    ("cmake/@NAME@-config.cmake", include_str!("template/config.cmake")),
    ("examples/loop.c", include_str!("template/loop.c")),
    ("examples/loop.cpp", include_str!("template/loop.cpp")),
    ("examples/CMakeLists.txt", include_str!("template/examples.cmake")),
    ("ros2/CMakeLists.txt", include_str!("template/ros2.cmake")),
    ("ros2/package.xml", include_str!("template/package.xml")),
    ("ros2/src/node.cpp", include_str!("template/node.cpp")),
    ("ros2/stand_in/rclcpp/rclcpp.hpp", include_str!("template/rclcpp.hpp")),
];
/// A second header that stands in where there is no ROS.
const MESSAGE: (&str, &str) =
    ("ros2/stand_in/std_msgs/msg/float64_multi_array.hpp", include_str!("template/float64_multi_array.hpp"));

impl Crate<'_> {
    /// Writes all files; how many there are.
    pub(super) fn write(&self, folder: &Path, force: bool) -> Result<usize, String> {
        let mut files: Vec<(String, String)> = vec![(format!("include/{}.h", self.name), self.header.to_owned())];
        files.extend(
            TEMPLATES
                .iter()
                .chain([&MESSAGE])
                .map(|(place, text)| (place.replace("@NAME@", self.name), self.fill(text))),
        );
        let (spec, text) = self.spec;
        files.push((format!("{}{spec}", self.below()), text.to_owned()));
        for (path, text) in self.loaded.iter().filter(|(path, _)| Path::new(path).is_relative()) {
            files.push((plain(&format!("{}{path}", self.below())), text.clone()));
        }
        if let Some(lock) = self.dependency.lock() {
            files.push(("Cargo.lock".to_owned(), lock));
        }
        for (place, _) in &files {
            let path = folder.join(place);
            if path.exists() && !force {
                return Err(format!("`{}` exists; give --force to replace it, or another folder", path.display()));
            }
        }
        for (place, text) in &files {
            let path = folder.join(place);
            // The spec and its tables may stand in the crate already, as they are written.
            if std::fs::read(&path).is_ok_and(|own| own != text.as_bytes()) {
                crate::write::spares(&[path], self.read)?;
            }
        }
        for (place, text) in &files {
            let path = folder.join(place);
            let parent = path.parent().unwrap_or(folder);
            std::fs::create_dir_all(parent).map_err(|error| match crate::write::file_above(parent) {
                Some(file) => format!("`{}` is a file, and no folder; give another name", file.display()),
                None => format!("cannot make `{}`: {error}", parent.display()),
            })?;
            crate::write::whole(&path, force, text.as_bytes())?;
        }
        Ok(files.len())
    }

    fn fill(&self, template: &str) -> String {
        let text = template
            .replace("@NTG@", &self.dependency.line("ntg"))
            .replace("@NTG_C@", &self.dependency.line("ntg-c"))
            .replace("@SPEC@", &format!("{}{}", self.below(), self.spec.0))
            .replace("@FILE@", self.spec.0)
            .replace("@PROBLEM@", self.problem);
        self.loops.fill(&text)
    }

    /// The folder of the spec: so deep that the paths of its tables stay within the crate.
    fn below(&self) -> String {
        let above = |(path, _): &(String, String)| {
            Path::new(path).components().filter(|component| *component == Component::ParentDir).count()
        };
        let depth = self.loaded.iter().map(above).max().unwrap_or(0);
        format!("spec/{}", "in/".repeat(depth))
    }
}

/// A path without `..`.
fn plain(path: &str) -> String {
    let mut parts: Vec<&str> = vec![];
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn a_path_upwards_stays_in_the_crate() {
        assert_eq!(plain("spec/in/../data/a.csv"), "spec/data/a.csv");
        assert_eq!(plain("spec/./a.csv"), "spec/a.csv");
    }
}
