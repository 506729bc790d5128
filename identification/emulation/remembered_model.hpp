// What a dear model has said stays known, in this run and in the next.
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

/// Asks another model for what it has not been asked yet, and keeps the answers, in memory and, as
/// they come, in a journal. Once the other has failed no thread asks it again. Slopes are passed on
/// and not kept.
class RememberedModel final : public OutsideModel {
 public:
  /// Takes the answers that `journal` has (empty: none, and none is kept). `identity` says what
  /// they belong to. Throws io::FileError: foreign, mismatch, corrupt, unwritable.
  RememberedModel(std::shared_ptr<OutsideModel> model, const std::filesystem::path& journal,
                  const std::string& identity);

  [[nodiscard]] int inputs() const override { return model_->inputs(); }
  [[nodiscard]] int outputs() const override { return model_->outputs(); }
  /// Throws as the model does, saying what is kept, and io::FileError.
  void evaluate(std::span<const double> x, std::span<double> y) override;
  bool gradient(std::span<const double> x, std::span<const double> sensitivity,
                std::span<double> slope) override;

  [[nodiscard]] long asked() const { return asked_; }  ///< times that the other had to answer
  [[nodiscard]] long remembered() const { return remembered_; }  ///< answers of before
  [[nodiscard]] long slopes() const { return slopes_; }

 private:
  template <class Ask>
  auto asking(const Ask& ask);

  std::shared_ptr<OutsideModel> model_;
  std::filesystem::path path_;
  std::mutex mutex_;
  std::unordered_map<std::string, std::vector<double>> answers_;  // by the bytes of x
  std::optional<emulator::Journal> journal_;
  std::optional<OutsideModelError> failure_;
  std::atomic<long> asked_{0}, slopes_{0};
  long remembered_ = 0;
};

}  // namespace wheeltap::identification
