// From raw accelerations to damage by the program's own commands, on random frames.
//
//   records_to_damage [--seed N] [--cases N] [--first N] [--program WHEELTAP] [--files DIR]
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "frame_case.hpp"
#include "frame_record.hpp"

int main(int argc, char** argv) {
  using namespace wheeltap::coverage;
  std::uint64_t seed = 1;
  int cases = 1, first = 0;
  std::filesystem::path files = "records-to-damage";
  CLI::App app("From accelerations of random frames to damage.");
  app.add_option("--seed", seed, "of the study");
  app.add_option("--cases", cases, "how many");
  app.add_option("--first", first, "number of the first");
  app.add_option("--files", files, "folder of the cases' files");
  CLI11_PARSE(app, argc, argv);
  for (int i = first; i < first + cases; ++i) {
    const FrameCase c = frame_case(seed, i);
    const std::filesystem::path folder = files / std::to_string(i);
    std::filesystem::create_directories(folder);
    const auto write = [&](const char* name, const nlohmann::json& json) {
      std::ofstream(folder / name) << json.dump(1) << '\n';
    };
    write("damage.json", c.damage);
    write("healthy.json", c.healthy);
    write("damaged.json", c.damaged);
    write_csv(folder / "healthy.csv",
              accelerations(c.state_healthy, c.damping, 0.05, 1000 * seed + 2 * i));
    write_csv(folder / "damaged.csv",
              accelerations(c.state_damaged, c.damping, 0.05, 1000 * seed + 2 * i + 1));
    std::printf("%d %s: E %.4g %.4g, damaged %d member %d at %.3f r %.3f zeta %.4f\n", i,
                c.name.c_str(), c.posts_young, c.girders_young, c.is_damaged, c.member, c.along,
                c.reduction, c.damping);
    for (double f : c.healthy_hz) std::printf(" %.4f", f);
    std::printf("\n");
    for (double f : c.damaged_hz) std::printf(" %.4f", f);
    std::printf("\n");
  }
}
