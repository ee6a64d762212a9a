//! Small IGES files, laid out in sections.

/// A file in the making.
#[derive(Default)]
pub struct File {
    directory: Vec<String>,
    parameter: Vec<String>,
    /// Fields of the global section from the scale on: scale, flag, name, …
    pub units: String,
}

/// What a directory entry says beside its type.
#[derive(Clone, Copy)]
pub struct Entry<'a> {
    pub kind: u32,
    pub form: i32,
    pub matrix: u64,
    pub status: &'a str,
    pub label: &'a str,
}

pub fn entry(kind: u32) -> Entry<'static> {
    Entry { kind, form: 0, matrix: 0, status: "00000000", label: "" }
}

impl File {
    pub fn new() -> Self {
        Self { units: "1.0,2,2HMM,1,0.1,15H20260101.000000,1D-6,1000.0,,,11,0,".into(), ..Self::default() }
    }

    /// Adds an entity with its parameter data (without type and end); answers its number.
    pub fn add(&mut self, e: Entry, data: &str) -> u64 {
        let number = self.directory.len() as u64 + 1;
        let text = format!("{},{data};", e.kind);
        let first = self.parameter.len() + 1;
        let mut lines: Vec<String> = Vec::new();
        let mut line = String::new();
        for field in text.split_inclusive([',', ';']) {
            if line.len() + field.len() > 64 {
                lines.push(std::mem::take(&mut line));
            }
            line.push_str(field);
        }
        lines.push(line);
        for l in &lines {
            let n = self.parameter.len() + 1;
            self.parameter.push(format!("{l:<64}{number:>8}P{n:>7}"));
        }
        let (kind, matrix, status, label, form, count) = (e.kind, e.matrix, e.status, e.label, e.form, lines.len());
        let first_line = format!("{kind:>8}{first:>8}{0:>8}{0:>8}{0:>8}{0:>8}{matrix:>8}{0:>8}{status:>8}", 0);
        let second = format!("{kind:>8}{0:>8}{0:>8}{count:>8}{form:>8}{1:>16}{label:>8}{0:>8}", 0, "");
        self.directory.push(format!("{first_line}D{number:>7}"));
        self.directory.push(format!("{second}D{:>7}", number + 1));
        number
    }

    /// The lines of the file.
    pub fn lines(&self) -> Vec<String> {
        let mut out = vec![format!("{:<72}S{:>7}", "a small file", 1)];
        let global = format!("1H,,1H;,4Hpart,8Hpart.igs,4Htest,4Htest,32,38,6,308,15,4Hpart,{};", self.units);
        for (i, l) in global.as_bytes().chunks(72).enumerate() {
            out.push(format!("{:<72}G{:>7}", String::from_utf8_lossy(l), i + 1));
        }
        out.extend(self.directory.iter().cloned());
        out.extend(self.parameter.iter().cloned());
        out.push(format!("{:<72}T{:>7}", "", 1));
        out
    }

    pub fn bytes(&self) -> Vec<u8> {
        (self.lines().join("\n") + "\n").into_bytes()
    }

    /// A plane patch of degree 1, `width` by `height`, as a rational B-spline surface.
    pub fn rectangle(&mut self, e: Entry, width: f64, height: f64) -> u64 {
        let (w, h) = (width, height);
        self.add(
            Entry { kind: 128, ..e },
            &format!("1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,0.,{w:?},0.,0.,0.,{h:?},0.,{w:?},{h:?},0.,0.,1.,0.,1."),
        )
    }

    /// A closed polygon as a chain of lines.
    pub fn polygon(&mut self, points: &[[f64; 3]], status: &'static str) -> u64 {
        let n = points.len();
        let lines: Vec<String> = (0..n)
            .map(|i| {
                let (p, q) = (points[i], points[(i + 1) % n]);
                let data = [p, q].concat().iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(",");
                self.add(Entry { status, ..entry(110) }, &data).to_string()
            })
            .collect();
        self.add(Entry { status, ..entry(102) }, &format!("{n},{}", lines.join(",")))
    }
}
