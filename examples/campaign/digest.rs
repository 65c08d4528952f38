//! SHA-256 of files.

use auv_examples::Failure;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{Read, Result};

/// Hashes bytes as they come.
#[derive(Default)]
pub(crate) struct Sha(Sha256);

impl Sha {
    pub(crate) fn update(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// The hash in hexadecimal digits.
    pub(crate) fn hex(self) -> String {
        let digest = self.0.finalize();
        digest.iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// The hash of these bytes.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    let mut sha = Sha::default();
    sha.update(bytes);
    sha.hex()
}

/// The hash of the running program.
pub(crate) fn program_sha256() -> std::result::Result<String, Failure> {
    read_program().map_err(|error| {
        let text = format!("the program cannot read its own file ({error})");
        Failure::BadInput(format!("{text}: make it readable"))
    })
}

fn read_program() -> Result<String> {
    // On Linux this is the running file even if another has taken its name since.
    let file = File::open("/proc/self/exe").or_else(|_| File::open(std::env::current_exe()?));
    let (mut file, mut sha) = (file?, Sha::default());
    let mut buffer = vec![0; 1 << 18];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(sha.hex()),
            read => sha.update(&buffer[..read]),
        }
    }
}
