#include "apps/checkpoint_file.hpp"

#include <charconv>
#include <iostream>
#include <utility>

#include "apps/several_ranks.hpp"
#include "io/atomic_file.hpp"
#include "io/bytes.hpp"
#include "io/fingerprint.hpp"
#include "io/netcdf_reader.hpp"
#include "io/netcdf_writer.hpp"

namespace wheeltap::apps {
namespace {

using inference::Checkpoint;
using io::FileError;
namespace fs = std::filesystem;

constexpr std::size_t kSeal = 16;  // digits
constexpr const char* kWhat = "a checkpoint of wheeltap";

bool is_sealed(std::string_view bytes) {
  return bytes.starts_with(io::kNetcdfMagic) && bytes.size() > kSeal &&
         io::fingerprint(bytes.substr(0, bytes.size() - kSeal)) ==
             bytes.substr(bytes.size() - kSeal);
}

[[noreturn]] void differs(const fs::path& path, const std::string& how) {
  throw FileError(FileError::Kind::mismatch, path,
                  "is of another run: " + how + " (without --resume a new one begins)");
}

std::string at(const Json& json, const Json::json_pointer& pointer) {
  constexpr std::size_t kLong = 40;
  if (!json.contains(pointer)) return "missing";
  std::string text = json[pointer].dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > kLong) text = text.substr(0, kLong) + "...";
  return text;
}

// The first place where two cases are not the same.
std::string difference(const Json& was, const Json& is) {
  const Json patch = Json::diff(was, is);
  if (patch.empty()) return {};
  const auto place = patch[0]["path"].get<std::string>();
  const Json::json_pointer pointer(place);
  return place + " was " + at(was, pointer) + " and is " + at(is, pointer);
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
  return identification::StepsRefined{.by_series = place.at("by_series"),
                                      .step_limit = place.at("step_limit"),
                                      .prefer_series = place.at("prefer_series"),
                                      .repeats = place.at("repeats")};
}

// f(vector of T) for the column type whose NetCDF type this is.
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

}  // namespace

CheckpointFile::CheckpointFile(const fs::path& folder, CheckpointOf of, const CommonOptions& common,
                               bool others_pass)
    : path_(folder / kName), of_(std::move(of)), every_seconds_(common.checkpoint_seconds) {
  const auto bytes = first_rank_says([&]() -> std::optional<std::string> {
    { const io::AtomicFile writable(path_); }  // and what a killed run left half-written is gone
    if (!fs::exists(path_)) return {};
    std::string found = io::read_bytes(path_);
    if (common.resume) return found;
    if (!is_sealed(found)) {
      throw FileError(FileError::Kind::unwritable, path_,
                      std::string("is in the way: not ") + kWhat + ", and not to be written over");
    }
    remove();
    return {};
  });
  if (bytes) read(*bytes, others_pass);
}

void CheckpointFile::read(std::string bytes, bool others_pass) {
  if (!bytes.starts_with(io::kNetcdfMagic)) {
    throw FileError(FileError::Kind::foreign, path_, std::string("is not ") + kWhat);
  }
  if (!is_sealed(bytes)) {
    throw FileError(FileError::Kind::corrupt, path_,
                    std::string("is truncated or damaged, or not ") + kWhat);
  }
  bytes.resize(bytes.size() - kSeal);
  const io::NetcdfReader file(std::move(bytes), path_, kWhat);
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
    refined_ = refined_of(Report::parse(text("repeat")));
  } catch (const Json::exception&) {
    file.foreign("has texts that cannot be read");
  }
  const int state = file.required_group("state");
  auto read = std::make_shared<Checkpoint>();
  for (const std::string& name : file.variables(state)) {
    const bool known = with_column_of(file.type(state, name), [&](auto numbers) {
      read->columns[name] = file.column<decltype(numbers)>(state, name);
    });
    if (!known) file.foreign("has another \"" + name + "\"");
  }
  from_ = std::move(read);
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
    text("repeat", place_of(refined_).dump());
    const int state = file.group("state");
    for (const auto& [name, column] : checkpoint.columns) {
      std::visit([&, &name = name](const auto& numbers) { file.column(state, name, numbers); },
                 column);
    }
    std::string bytes = file.close();
    bytes += io::fingerprint(bytes);
    io::AtomicFile whole(path_);
    whole.write(bytes);
    whole.commit();
    kept_ = true;
  } catch (const FileError& error) {
    if (!std::exchange(warned_, true)) {
      std::cerr << "wheeltap: no checkpoint, the run goes on without: " << error.what() << '\n';
    }
  }
}

void CheckpointFile::attach(inference::Options& engine) {
  engine.checkpoints.from = std::exchange(from_, nullptr);
  if (every_seconds_ <= 0.0) return;
  engine.checkpoints.every_seconds = every_seconds_;
  engine.checkpoints.save = [this](const Checkpoint& checkpoint) { save(checkpoint); };
}

void CheckpointFile::discard(const fs::path& folder) {
  const fs::path path = folder / kName;
  { const io::AtomicFile writable(path); }
  std::error_code ignored;
  if (fs::exists(path) && is_sealed(io::read_bytes(path))) fs::remove(path, ignored);
}

void CheckpointFile::remove() {
  if (!base::is_first_rank()) return;
  std::error_code ignored;
  fs::remove(path_, ignored);
  kept_ = false;
}

}  // namespace wheeltap::apps
