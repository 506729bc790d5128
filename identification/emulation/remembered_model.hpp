// A cache for the results of an expensive external model, within and between program runs.
#pragma once

#include <atomic>
#include <filesystem>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include "emulator/journal.hpp"
#include "identification/emulation/outside_model.hpp"

namespace wheeltap::identification {

/// Evaluates an external model only at inputs for which no result is stored. Each result is stored
/// in memory and immediately in a journal file. After the first failure of the model, no thread
/// evaluates the model again. Gradients are not cached.
class RememberedModel final : public OutsideModel {
 public:
  /// Reads the stored results from the file `journal`; an empty path disables the journal.
  /// `identity` identifies the model to which the results belong. Throws io::FileError with the
  /// reason `foreign`, `mismatch`, `corrupt` or `unwritable`.
  RememberedModel(std::shared_ptr<OutsideModel> model, const std::filesystem::path& journal,
                  const std::string& identity);

  [[nodiscard]] int inputs() const override { return model_->inputs(); }
  [[nodiscard]] int outputs() const override { return model_->outputs(); }
  /// Throws io::FileError and the exceptions of the model. The messages of the model's exceptions
  /// also state the number of stored results.
  void evaluate(std::span<const double> x, std::span<double> y) override;
  bool gradient(std::span<const double> x, std::span<const double> sensitivity,
                std::span<double> slope) override;

  [[nodiscard]] long asked() const { return asked_; }  ///< number of model evaluations
  /// Number of results read from the journal
  [[nodiscard]] long remembered() const { return remembered_; }
  [[nodiscard]] long slopes() const { return slopes_; }

 private:
  template <class Ask>
  auto asking(const Ask& ask);

  std::shared_ptr<OutsideModel> model_;
  std::filesystem::path path_;
  std::mutex mutex_;
  // Stored results; the key contains the bytes of x
  std::unordered_map<std::string, std::vector<double>> answers_;
  std::optional<emulator::Journal> journal_;
  std::optional<OutsideModelError> failure_;
  std::atomic<long> asked_{0}, slopes_{0};
  long remembered_ = 0;
};

}  // namespace wheeltap::identification
