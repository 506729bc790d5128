#include "apps/runs/checkpoint_file.hpp"

#include <charconv>
#include <iostream>
#include <set>
#include <string_view>
#include <utility>

#include "apps/runs/several_ranks.hpp"
#include "io/atomic_file.hpp"
#include "io/bytes.hpp"
#include "io/fingerprint.hpp"
#include "io/netcdf/netcdf_reader.hpp"
#include "io/netcdf/netcdf_writer.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

using inference::Checkpoint;
using io::FileError;
namespace fs = std::filesystem;

constexpr std::size_t kSeal = 16;  // digits of the seal
constexpr const char* kCheckpointFormat = "a checkpoint of wheeltap";
constexpr std::string_view kPartPrefix = "checkpoint-";

bool is_sealed_checkpoint(std::string_view bytes) {
  return bytes.starts_with(io::kNetcdfMagic) && bytes.size() > kSeal &&
         io::fingerprint(bytes.substr(0, bytes.size() - kSeal)) ==
             bytes.substr(bytes.size() - kSeal);
}

std::string_view seal_of(std::string_view bytes) {
  return bytes.substr(bytes.size() - kSeal);
}

// File numbers of all parts in a folder, including incomplete files.
std::set<long> parts_in(const fs::path& folder) {
  std::set<long> numbers;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kPartPrefix)) continue;
    long number = -1;
    const char* from = name.data() + kPartPrefix.size();
    const auto [end, error] = std::from_chars(from, name.data() + name.size(), number);
    const std::string_view rest(end, static_cast<std::size_t>(name.data() + name.size() - end));
    if (error == std::errc{} && number >= 0 && (rest == ".nc" || rest.starts_with(".nc.part")))
      numbers.insert(number);
  }
  return numbers;
}

// Removes a part and its temporary file. Returns false if the file is unreadable or not a part.
bool remove_part(const fs::path& path) {
  try {
    { const io::AtomicFile writable(path); }
    if (!fs::exists(path)) return true;
    if (!is_sealed_checkpoint(io::read_bytes(path))) return false;
  } catch (const FileError&) {
    return false;
  }
  std::error_code ignored;
  fs::remove(path, ignored);
  return true;
}

void write_state(const io::NetcdfWriter& file, const Checkpoint& checkpoint) {
  const int state = file.group("state");
  for (const auto& [name, column] : checkpoint.columns) {
    std::visit([&, &name = name](const auto& numbers) { file.column(state, name, numbers); },
               column);
  }
}

// Writes a file with a seal at its end, and returns the seal.
std::string write_sealed(const fs::path& path, io::NetcdfWriter& file) {
  const std::string bytes = file.close();
  std::string seal = io::fingerprint(bytes);
  io::AtomicFile whole(path);
  whole.write(bytes);
  whole.append(seal);
  whole.commit();
  return seal;
}

[[noreturn]] void in_the_way(const fs::path& path) {
  throw FileError(FileError::Kind::unwritable, path,
                  std::string("exists already and is not ") + kCheckpointFormat +
                      ", so Wheeltap does not overwrite it: remove it or choose another folder");
}

[[noreturn]] void differs(const fs::path& path, const std::string& how) {
  throw FileError(FileError::Kind::mismatch, path,
                  "is of another run: " + how + " (omit --resume to start a new run)");
}

std::string member_at(const Json& json, const Json::json_pointer& pointer) {
  constexpr std::size_t kLong = 40;
  if (!json.contains(pointer)) return "missing";
  std::string text = json[pointer].dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > kLong) text = text.substr(0, kLong) + "...";
  return text;
}

// The first difference between two cases.
std::string difference(const Json& was, const Json& is) {
  const Json patch = Json::diff(was, is);
  if (patch.empty()) return {};
  const auto place = patch[0]["path"].get<std::string>();
  const Json::json_pointer pointer(place);
  return place + " was " + member_at(was, pointer) + " and is " + member_at(is, pointer);
}

// The first input file that has changed, is new or is missing; empty if all are unchanged.
std::optional<std::string> changed_input(const Json& was, const Json& is) {
  for (const auto& [name, content] : was.items())
    if (!is.contains(name) || is[name] != content) return name;
  for (const auto& [name, content] : is.items())
    if (!was.contains(name)) return name;
  return {};
}

Report place_of(const std::optional<identification::StepsRefined>& refined) {
  if (!refined) return nullptr;
  return {{"repeats", refined->repeats},
          {"by_series", refined->by_series},
          {"prefer_series", refined->prefer_series},
          {"step_limit", refined->step_limit}};
}

std::optional<identification::StepsRefined> refined_of(const Report& place) {
  if (place.is_null()) return {};
  return identification::StepsRefined{.by_series = place.at("by_series").get<bool>(),
                                      .step_limit = place.at("step_limit").get<double>(),
                                      .prefer_series = place.at("prefer_series").get<bool>(),
                                      .repeats = place.at("repeats").get<int>()};
}

// Calls f(vector of T) for the column type of this NetCDF type.
template <std::size_t I = 0, class F>
bool with_column_of(nc_type type, F&& f) {
  if constexpr (I < std::variant_size_v<Checkpoint::Column>) {
    using Numbers = std::variant_alternative_t<I, Checkpoint::Column>;
    if (type != io::kNetcdfType<typename Numbers::value_type>)
      return with_column_of<I + 1>(type, f);
    f(Numbers{});
    return true;
  }
  return false;
}

Checkpoint read_state(const io::NetcdfReader& file) {
  const int state = file.required_group("state");
  Checkpoint read;
  for (const std::string& name : file.variables(state)) {
    const bool known = with_column_of(file.type(state, name), [&](auto numbers) {
      read.columns[name] = file.column<decltype(numbers)>(state, name);
    });
    if (!known) file.foreign("has another \"" + name + "\"");
  }
  return read;
}

}  // namespace

CheckpointFile::CheckpointFile(const fs::path& folder, CheckpointOf of, const CommonOptions& common,
                               bool others_pass)
    : path_(folder / kName), of_(std::move(of)), every_seconds_(common.checkpoint_seconds) {
  const auto bytes = first_rank_says([&]() -> std::optional<std::string> {
    { const io::AtomicFile writable(path_); }  // also removes the temporary file of a killed run
    const bool there = fs::exists(path_);
    std::string found = there ? io::read_bytes(path_) : std::string();
    if (there && common.resume) return found;
    if (there && !is_sealed_checkpoint(found)) in_the_way(path_);
    for (const long number : parts_in(path_.parent_path()))
      if (!remove_part(part(number))) in_the_way(part(number));
    if (there) remove();
    return {};
  });
  if (bytes) read(*bytes, others_pass);
}

void CheckpointFile::read(std::string bytes, bool others_pass) {
  if (!bytes.starts_with(io::kNetcdfMagic)) {
    throw FileError(FileError::Kind::foreign, path_, std::string("is not ") + kCheckpointFormat);
  }
  if (!is_sealed_checkpoint(bytes)) {
    throw FileError(FileError::Kind::corrupt, path_,
                    std::string("is truncated or corrupt, or not ") + kCheckpointFormat);
  }
  bytes.resize(bytes.size() - kSeal);
  const io::NetcdfReader file(std::move(bytes), path_, kCheckpointFormat);
  const std::string format = file.text("wheeltap_checkpoint");
  if (format.empty()) file.foreign("has no attribute \"wheeltap_checkpoint\"");
  const int run = file.required_group("run");
  const auto text = [&](const char* name) { return file.column<std::string>(run, name); };
  if (const std::string was = text("version"); was != WHEELTAP_VERSION) {
    differs(path_, "wheeltap was " + was + " and is " + WHEELTAP_VERSION);
  }
  if (format != std::to_string(Checkpoint::kFormat)) {
    throw FileError(
        FileError::Kind::version, path_,
        "has format " + format + ", this program reads " + std::to_string(Checkpoint::kFormat));
  }
  const auto same = [&](const char* what, const std::string& was, const std::string& is) {
    if (was != is) differs(path_, std::string(what) + " was " + was + " and is " + is);
  };
  same("the command", text("command"), of_.command);
  same("the seed", text("seed"), std::to_string(of_.seed));
  try {
    if (const auto how = difference(Json::parse(text("options")), Json::parse(of_.options.dump()));
        !how.empty()) {
      differs(path_, "the option " + how);
    }
    if (const auto how = difference(Json::parse(text("case")), of_.case_json); !how.empty()) {
      if (others_pass) return;
      differs(path_, how);
    }
    if (const auto changed = changed_input(Json::parse(text("inputs")), of_.inputs)) {
      if (base::is_first_rank())
        std::cerr << "wheeltap: " << io::printable(*changed)
                  << " has changed since the checkpoint: a new run begins\n";
      return;
    }
    refined_ = refined_of(Report::parse(text("repeat")));
    for (const Json& part : Json::parse(text("parts")))
      seals_[part.at(0).get<long>()] = part.at(1).get<std::string>();
  } catch (const Json::exception&) {
    file.foreign("has unreadable strings");
  }
  from_ = std::make_shared<const Checkpoint>(read_state(file));
  if (!seals_.empty()) first_ = seals_.begin()->first - inference::parts_of(*from_).first;
  kept_ = true;
}

void CheckpointFile::save(const Checkpoint& checkpoint) {
  try {
    io::NetcdfWriter file(path_);
    file.text(file.root(), NC_GLOBAL, "wheeltap_checkpoint", std::to_string(Checkpoint::kFormat));
    const int run = file.group("run");
    const auto text = [&](const char* name, const std::string& value) {
      file.column(run, name, value);
    };
    text("version", WHEELTAP_VERSION);
    text("command", of_.command);
    text("seed", std::to_string(of_.seed));
    text("options", of_.options.dump());
    text("case", of_.case_json.dump());
    text("inputs", of_.inputs.dump());
    text("repeat", place_of(refined_).dump());
    const auto [first_part, parts] = inference::parts_of(checkpoint);
    const long first = first_ + first_part;
    Json seals = Json::array();
    for (long n = first; n < first + parts; ++n) seals.push_back({n, seals_.at(n)});
    text("parts", seals.dump());
    write_state(file, checkpoint);
    write_sealed(path_, file);
    kept_ = true;
    // Remove parts that the checkpoint no longer needs.
    std::error_code ignored;
    for (; !seals_.empty() && seals_.begin()->first < first; seals_.erase(seals_.begin()))
      fs::remove(part(seals_.begin()->first), ignored);
  } catch (const FileError& error) {
    warn(error);
  }
}

bool CheckpointFile::save_draws(const Checkpoint& draws, long number) {
  number += first_;
  try {
    if (fs::exists(part(number)) && !is_sealed_checkpoint(io::read_bytes(part(number))))
      in_the_way(part(number));
    io::NetcdfWriter file(part(number));
    file.text(file.root(), NC_GLOBAL, "wheeltap_checkpoint", std::to_string(Checkpoint::kFormat));
    write_state(file, draws);
    seals_[number] = write_sealed(part(number), file);
    return true;
  } catch (const FileError& error) {
    warn(error);
    return false;
  }
}

Checkpoint CheckpointFile::saved_draws(long number) const {
  number += first_;
  const auto seal = seals_.find(number);
  const fs::path path = part(number);
  const auto damaged = [&](const std::string& how) {
    return FileError(FileError::Kind::corrupt, path, how + ": " + path_.string() + " needs it");
  };
  if (seal == seals_.end()) throw damaged("is not known");
  auto bytes = first_rank_says([&]() -> std::optional<std::string> {
    if (!fs::exists(path)) throw damaged("does not exist");
    return io::read_bytes(path);
  });
  if (!is_sealed_checkpoint(*bytes) || seal_of(*bytes) != seal->second)
    throw damaged("is truncated or corrupt, or is a part of another checkpoint");
  bytes->resize(bytes->size() - kSeal);
  return read_state(io::NetcdfReader(std::move(*bytes), path, kCheckpointFormat));
}

fs::path CheckpointFile::part(long number) const {
  return path_.parent_path() / (std::string(kPartPrefix) + std::to_string(number) + ".nc");
}

void CheckpointFile::warn(const std::exception& error) {
  if (!std::exchange(warned_, true))
    std::cerr << "wheeltap: the run continues without checkpoint: " << error.what() << '\n';
}

void CheckpointFile::attach(inference::Options& engine) {
  engine.checkpoints.from = std::exchange(from_, nullptr);
  engine.checkpoints.saved_draws = [this](long number) { return saved_draws(number); };
  if (every_seconds_ <= 0.0) return;
  engine.checkpoints.every_seconds = every_seconds_;
  engine.checkpoints.save = [this](const Checkpoint& checkpoint) { save(checkpoint); };
  engine.checkpoints.save_draws = [this](const Checkpoint& draws, long number) {
    return save_draws(draws, number);
  };
}

void CheckpointFile::discard(const fs::path& folder) {
  const fs::path path = folder / kName;
  { const io::AtomicFile writable(path); }
  std::error_code ignored;
  if (fs::exists(path) && is_sealed_checkpoint(io::read_bytes(path))) fs::remove(path, ignored);
  for (const long number : parts_in(folder))
    remove_part(folder / (std::string(kPartPrefix) + std::to_string(number) + ".nc"));
}

void CheckpointFile::remove() {
  if (!base::is_first_rank()) return;
  std::error_code ignored;
  fs::remove(path_, ignored);
  kept_ = false;
  for (const long number : parts_in(path_.parent_path())) remove_part(part(number));
  seals_.clear();
}

}  // namespace wheeltap::apps
