//! Threads that stand for the ranks of a job.

use rockproof_campaign::distribute::Transport;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

/// Ranks that are threads.
pub(crate) struct Threads {
    pub(crate) own: usize,
    others: Vec<Sender<(usize, Vec<u8>)>>,
    inbox: Receiver<(usize, Vec<u8>)>,
    /// Messages between an error in one of them and the next; 0 for none.
    pub(crate) damage: u64,
    sent: u64,
    /// How long a message takes.
    delay: Duration,
}

impl Threads {
    pub(crate) fn all(ranks: usize) -> Vec<Threads> {
        let (others, inboxes): (Vec<_>, Vec<_>) = (0..ranks).map(|_| channel()).unzip();
        let one = |(own, inbox)| Threads {
            own,
            others: others.clone(),
            inbox,
            damage: 0,
            sent: 0,
            // The first workers are the slowest.
            delay: Duration::from_micros(300 * (ranks - own) as u64),
        };
        inboxes.into_iter().enumerate().map(one).collect()
    }
}

impl Transport for Threads {
    fn ranks(&self) -> usize {
        self.others.len()
    }

    fn send(&mut self, to: usize, message: &[u8]) {
        self.sent += 1;
        std::thread::sleep(if self.own == 0 { Duration::ZERO } else { self.delay });
        let damaged = self.damage > 0 && self.sent.is_multiple_of(self.damage) && message.len() > 8;
        let message = if damaged { &message[..message.len() / 2] } else { message };
        // Who has ended hears nothing.
        let _ = self.others[to].send((self.own, message.to_vec()));
    }

    fn receive(&mut self) -> Option<(usize, Vec<u8>)> {
        self.inbox.try_recv().ok()
    }
}
