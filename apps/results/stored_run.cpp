#include "apps/results/stored_run.hpp"

#include <algorithm>
#include <span>

#include "apps/failure.hpp"
#include "apps/json_text.hpp"
#include "io/atomic_file.hpp"
#include "io/bytes.hpp"
#include "io/fingerprint.hpp"
#include "io/netcdf/netcdf_reader.hpp"
#include "io/netcdf/write_netcdf.hpp"
#include "io/read_apart.hpp"

namespace wheeltap::apps {
namespace {

using io::FileError;
namespace fs = std::filesystem;

/// The run identifier in a posterior.nc; empty if it is missing or the file is corrupt.
std::string run_of(const fs::path& path) {
  try {
    return io::read_apart(path, [&] { return read_posterior(path, path)->text("run_id"); });
  } catch (const FileError&) {
    return {};
  }
}

/// The run identifier in a summary; empty if the summary has none.
std::string run_of(const Report& summary) {
  const auto about = summary.find("wheeltap");
  if (about == summary.end()) return {};
  const auto run = about->find("run");
  return run != about->end() && run->is_string() ? run->get<std::string>() : "";
}

std::uint64_t hashed(const auto& values, std::uint64_t hash) {
  const auto bytes = std::as_bytes(std::span(values));
  return io::fnv1a({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, hash);
}

}  // namespace

std::string run_id(const Report& about, const inference::Posterior& posterior) {
  std::uint64_t hash = io::fnv1a("");
  for (const auto& chain : posterior.chains) {
    hash = hashed(chain.theta, hashed(chain.model, hashed(chain.log_likelihood, hash)));
    chain.let_go();
  }
  std::string text = std::to_string(hash);
  for (const char* key : {"version", "command", "seed", "case"}) text += about[key].dump();
  return io::fingerprint(text);
}

Report seal(std::string_view bytes) {
  return {{"bytes", bytes.size()}, {"checksum", io::fingerprint(bytes)}};
}

Report seal_of_file(const fs::path& file) {
  const io::FileFingerprint is = io::fingerprint_of_file(file);
  return {{"bytes", is.bytes}, {"checksum", is.digits}};
}

std::unique_ptr<const io::NetcdfReader> read_posterior(const fs::path& file, const fs::path& name) {
  std::error_code unknown;
  if (fs::file_size(file, unknown) > io::kNetcdfInMemory && !unknown)
    return std::make_unique<const io::NetcdfReader>(file, kPosterior);
  return std::make_unique<const io::NetcdfReader>(io::read_bytes(file), name, kPosterior);
}

namespace {

/// Throws if the seal of a file, `is`, differs from the seal of the file that the run wrote.
void check_seal(const fs::path& path, const Report& wrote_one, const Report& summary,
                const Report& is) {
  if (wrote_one == is) return;
  const std::string of = run_of(summary), has = run_of(path);
  if (!has.empty() && has != of) {
    throw FileError(
        FileError::Kind::mismatch, path,
        "is of another run (" + has + ") than the summary.json in its folder (" + of + ")");
  }
  const Report wrote = wrote_one.is_object() ? wrote_one.value("bytes", Report()) : Report();
  const auto wanted = wrote.is_number_unsigned() ? wrote.get<std::size_t>() : 0;
  const auto there = is.at("bytes").get<std::size_t>();
  throw FileError(FileError::Kind::corrupt, path,
                  there < wanted ? "is truncated: it has " + std::to_string(there) + " of the " +
                                       std::to_string(wanted) + " bytes that its run wrote"
                                 : "is corrupt: its checksum differs from that in summary.json");
}

/// The seal of a file in a summary; null: the file was not written; std::nullopt: no entry.
std::optional<Report> seal_in(const Report& summary, const std::string& name) {
  const auto files = summary.find("files");
  if (files == summary.end() || !files->is_object() || !files->contains(name)) return {};
  return (*files)[name];
}

}  // namespace

bool is_sealed(const fs::path& folder, const std::string& name, const Report& summary) {
  const std::optional<Report> wrote = seal_in(summary, name);
  if (wrote && wrote->is_null()) return false;
  const fs::path path = folder / name;
  if (!fs::exists(path)) throw FileError(FileError::Kind::missing, path, "no such file");
  if (wrote) check_seal(path, *wrote, summary, seal_of_file(path));
  return true;
}

std::optional<std::string> sealed_file(const fs::path& folder, const std::string& name,
                                       const Report& summary) {
  const std::optional<Report> wrote = seal_in(summary, name);
  if (wrote && wrote->is_null()) return {};
  const fs::path path = folder / name;
  if (!fs::exists(path)) throw FileError(FileError::Kind::missing, path, "no such file");
  std::string bytes = io::read_bytes(path);
  if (wrote) check_seal(path, *wrote, summary, seal(bytes));
  return bytes;
}

std::optional<Report> stored_summary(const fs::path& folder) {
  try {
    const fs::path path = folder / "summary.json";
    return parse_json<Report>(path, io::read_bytes(path));
  } catch (const FileError&) {
    return {};
  } catch (const Failure&) {
    return {};
  }
}

std::optional<std::string> finished_run(const fs::path& folder, const CaseFile& file,
                                        std::uint64_t seed, const std::string& key,
                                        const Report& options) {
  io::finish_commit(folder);
  const std::optional<Report> stored = stored_summary(folder);
  if (!stored || !fs::exists(folder / "summary.txt") || !fs::exists(folder / "posterior.nc")) {
    return {};
  }
  const Report& summary = *stored;
  const auto has = [&](const char* name) {
    return summary.is_object() && summary.contains(name) && summary[name].is_object();
  };
  if (!has("files") || !has("wheeltap") || !has("diagnostics")) return {};
  const auto& about = summary["wheeltap"];
  const auto is = [&](const char* name, const Report& value) {
    return about.contains(name) && about[name] == value;
  };
  const auto& stopped = summary["diagnostics"].value("stopped_early", Report(true));
  const auto same = [&](const char* name, const Json& value) {
    return about.contains(name) && Json::parse(about[name].dump()) == value;
  };
  if (!is("version", WHEELTAP_VERSION) || !is("seed", seed) || !is(key.c_str(), options) ||
      !same("case", file.json) || !same("inputs", file.inputs->json()) || stopped != false) {
    return {};
  }
  if (!is_sealed(folder, "posterior.nc", summary)) return {};
  std::string text = io::read_bytes(folder / "summary.txt");
  const auto& of = summary["files"].value("summary.txt", Report::object());
  if (!text.ends_with('\n') || of != Report{{"lines", std::ranges::count(text, '\n')}}) {
    throw FileError(FileError::Kind::corrupt, folder / "summary.txt",
                    "is truncated or corrupt: its number of lines differs from that in "
                    "summary.json");
  }
  return text;
}

}  // namespace wheeltap::apps
