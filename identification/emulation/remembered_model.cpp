#include "identification/emulation/remembered_model.hpp"

#include <algorithm>
#include <cstring>

namespace wheeltap::identification {
namespace {

std::string key_of(std::span<const double> x) {
  std::string bytes(x.size_bytes(), '\0');
  std::memcpy(bytes.data(), x.data(), bytes.size());
  return bytes;
}

}  // namespace

RememberedModel::RememberedModel(std::shared_ptr<OutsideModel> model,
                                 const std::filesystem::path& journal, const std::string& identity)
    : model_(std::move(model)), path_(journal) {
  if (path_.empty()) return;
  const auto in = static_cast<std::size_t>(inputs()), out = static_cast<std::size_t>(outputs());
  // A record of the journal is x, then y.
  journal_.emplace(path_, identity, in + out, emulator::Journal::Use::shared);
  for (const auto& entry : journal_->entries()) {
    const std::span<const double> both(entry.response);
    const auto y = both.subspan(in);
    answers_.try_emplace(key_of(both.first(in)), y.begin(), y.end());
  }
  remembered_ = static_cast<long>(answers_.size());
}

template <class Ask>
auto RememberedModel::asking(const Ask& ask) {
  {
    const std::lock_guard lock(mutex_);
    if (failure_) throw OutsideModelError(*failure_);
  }
  try {
    return ask();
  } catch (const OutsideModelError& error) {
    const std::lock_guard lock(mutex_);
    if (!failure_) {
      std::string line = error.what();
      if (journal_)
        line += "; " + std::to_string(answers_.size()) +
                (answers_.size() == 1 ? " result is" : " results are") + " stored in " +
                path_.string() + "; --resume continues from the stored results";
      failure_.emplace(error.kind(), line);
    }
    throw OutsideModelError(*failure_);
  }
}

void RememberedModel::evaluate(std::span<const double> x, std::span<double> y) {
  std::string key = key_of(x);
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = answers_.find(key); known != answers_.end()) {
      std::ranges::copy(known->second, y.begin());
      return;
    }
  }
  asking([&] { model_->evaluate(x, y); });
  ++asked_;
  const std::lock_guard lock(mutex_);
  const auto [kept, is_new] = answers_.try_emplace(std::move(key), y.begin(), y.end());
  if (!is_new) {  // another thread stored a result meanwhile: return that result
    std::ranges::copy(kept->second, y.begin());
    return;
  }
  if (!journal_) return;
  std::vector<double> both(x.begin(), x.end());
  both.insert(both.end(), y.begin(), y.end());
  journal_->append(static_cast<std::int64_t>(answers_.size()) - 1, both);
}

bool RememberedModel::gradient(std::span<const double> x, std::span<const double> sensitivity,
                               std::span<double> slope) {
  const bool has = asking([&] { return model_->gradient(x, sensitivity, slope); });
  slopes_ += has ? 1 : 0;
  return has;
}

}  // namespace wheeltap::identification
