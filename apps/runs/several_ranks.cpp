#include "apps/runs/several_ranks.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <limits>

#include "base/simd.hpp"

namespace wheeltap::apps {
namespace {

constexpr const char* kModule = "wheeltap_mpi.so";
constexpr double kRankPatience =
    30.0;  // [s]: time that a failed rank waits for other ranks to fail too

// Environment variables that a launcher sets.
bool is_launched() {
  for (const char* variable : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK"}) {
    if (std::getenv(variable) != nullptr) return true;
  }
  return false;
}

bool is_one_of_several() {
  const char* size = std::getenv("OMPI_COMM_WORLD_SIZE");
  return size != nullptr && std::string(size) != "1";
}

// Loads the MPI module from the folder of the program, or from its installation folder.
void* load_module() {
  std::error_code ignored;
  const std::filesystem::path here =
      std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const std::filesystem::path& place : {here / kModule, here / WHEELTAP_MODULES / kModule}) {
    // RTLD_GLOBAL is necessary: components of Open MPI search for global symbols of Open MPI.
    if (void* module = dlopen(place.c_str(), RTLD_NOW | RTLD_GLOBAL)) return module;
  }
  return nullptr;
}

std::string processor() {
  if (const char* chosen = std::getenv(base::kInstructionsVariable)) return chosen;
  std::string text;
#if defined(__x86_64__) && defined(__GNUC__)
  text += __builtin_cpu_supports("avx2") ? "avx2 " : "";
  text += __builtin_cpu_supports("fma") ? "fma " : "";
  text += __builtin_cpu_supports("avx512f") ? "avx512f " : "";
  text += __builtin_cpu_supports("avx512dq") ? "avx512dq " : "";
  text += __builtin_cpu_supports("avx512vl") ? "avx512vl " : "";
#endif
  return text;
}

}  // namespace

JoinedRanks::JoinedRanks() {
  if (!is_launched()) return;
  void* module = load_module();
  if (module == nullptr) {
    if (!is_one_of_several()) return;
    throw Failure(Exit::usage, std::string("started by mpirun, but ") + kModule +
                                   " is missing: this wheeltap was built without MPI");
  }
  const auto join = reinterpret_cast<base::Ranks* (*)()>(dlsym(module, "wheeltap_join_ranks"));
  if (join == nullptr)
    throw Failure(Exit::internal, std::string(kModule) + " is of another version of wheeltap");
  base::Ranks* all = join();
  if (all->size() == 1) {
    delete all;
    return;
  }
  base::ranks() = all_ = all;
  if (all->rank() > 0) {
    said_ = dup(STDERR_FILENO);
    const int nothing = open("/dev/null", O_WRONLY);
    dup2(nothing, STDOUT_FILENO);
    dup2(nothing, STDERR_FILENO);
    close(nothing);
  }
}

JoinedRanks::~JoinedRanks() {
  base::ranks() = nullptr;
  delete all_;
}

void JoinedRanks::leave(int exit_code, const std::string& last_words) {
  if (all_ == nullptr) return;
  const double forever = std::numeric_limits<float>::max();
  if (all_->meet(exit_code == 0 ? forever : kRankPatience)) return;
  if (said_ >= 0) {
    const std::string line =
        "wheeltap: rank " + std::to_string(all_->rank()) + " only: " + last_words + '\n';
    static_cast<void>(!::write(said_, line.data(), line.size()));
  }
  all_->abort(exit_code);
}

void require_same_on_all_ranks(const std::string& what, const std::string& text) {
  if (base::Ranks* all = base::ranks(); all != nullptr && !all->all_have(text)) {
    throw Failure(Exit::bad_input, "the ranks do not have the same " + what +
                                       ": each rank reads files on its own machine");
  }
}

void require_equal_processors() {
  if (base::Ranks* all = base::ranks(); all != nullptr && !all->all_have(processor())) {
    throw Failure(Exit::usage,
                  "the ranks run on different processors, whose results differ in the last bit: "
                  "use --simd baseline");
  }
}

}  // namespace wheeltap::apps
