//! The server as a process, and just enough of HTTP to talk to it.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// A server that is ended when it is dropped.
pub struct Server {
    pub process: Child,
    pub address: String,
}

impl Server {
    /// Starts `rollin serve` in `folder` on a port that is free.
    pub fn start(folder: &Path, options: &str) -> Server {
        let mut process = Command::new(env!("CARGO_BIN_EXE_rollin"))
            .args(["serve", "--listen", "127.0.0.1:0"])
            .args(options.split_whitespace())
            .current_dir(folder)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program starts");
        let mut line = String::new();
        BufReader::new(process.stdout.as_mut().expect("a pipe")).read_line(&mut line).expect("a line");
        let address = line.trim().strip_prefix("listening on http://").expect("an address").to_owned();
        Server { process, address }
    }

    pub fn connect(&self) -> TcpStream {
        TcpStream::connect(&self.address).expect("it listens")
    }

    /// One request on a connection of its own.
    pub fn ask(&self, head: &str, body: &[u8]) -> (u16, String) {
        let mut stream = self.connect();
        send(&mut stream, head, body);
        receive(&mut BufReader::new(stream)).expect("an answer")
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Writes a request whose `head` is its first line and, after further lines' ends, headers.
pub fn send(stream: &mut TcpStream, head: &str, body: &[u8]) {
    let (first, headers) = head.split_once('\n').unwrap_or((head, ""));
    let mut request = format!("{first} HTTP/1.1\r\nHost: localhost\r\nContent-Length: {}\r\n", body.len());
    headers.lines().for_each(|header| request += &format!("{header}\r\n"));
    let mut bytes = (request + "\r\n").into_bytes();
    bytes.extend_from_slice(body);
    // A server that refuses a body may hang up before it has all of it.
    let _ = stream.write_all(&bytes);
}

/// Reads one answer; `None` where the connection ends before there is one.
pub fn receive(from: &mut BufReader<TcpStream>) -> Option<(u16, String)> {
    let (mut line, mut length) = (String::new(), 0);
    from.read_line(&mut line).ok()?;
    let status = line.split(' ').nth(1)?.parse().ok()?;
    loop {
        line.clear();
        from.read_line(&mut line).ok()?;
        let header = line.trim().to_ascii_lowercase();
        if let Some(value) = header.strip_prefix("content-length:") {
            length = value.trim().parse().ok()?;
        }
        if header.is_empty() {
            break;
        }
    }
    let mut body = vec![0; length];
    from.read_exact(&mut body).ok()?;
    Some((status, String::from_utf8_lossy(&body).into_owned()))
}
