// Signals with which users, schedulers and the operating system stop a program.
#pragma once

#include <array>
#include <csignal>

namespace wheeltap::base {

/// The signals of Ctrl-C, `kill` and a closed terminal, the two user signals, and SIGXCPU. mpirun
/// forwards the user signals to its ranks. Clusters send a user signal before the time limit of a
/// job (Slurm optionally; Grid Engine and LSF: SIGUSR2). After the limit of processor time, the
/// system sends SIGXCPU every second (setrlimit(2)).
inline constexpr std::array kStopSignals{SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU};

}  // namespace wheeltap::base
