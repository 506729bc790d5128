// The signals by which people, schedulers and the system ask a program to end.
#pragma once

#include <array>
#include <csignal>

namespace wheeltap::base {

/// Ctrl-C, `kill`, a terminal that is closed; what mpirun hands on to its ranks, and clusters send
/// before a job's time is up (Slurm by choice, Grid Engine and LSF SIGUSR2); and what the system
/// sends at a limit of processor time, every second from then on (setrlimit(2)).
inline constexpr std::array kStopSignals{SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU};

}  // namespace wheeltap::base
