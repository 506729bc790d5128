#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace wheeltap {

/// Expects `call` to throw std::invalid_argument with a message that contains all of `words`.
template <class Call>
void expect_refusal(Call&& call, std::initializer_list<std::string> words) {
  try {
    call();
    ADD_FAILURE() << "not refused; expected a message with \"" << *words.begin() << "\"";
  } catch (const std::invalid_argument& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << "\"" << word << "\" is not in: " << error.what();
  }
}

}  // namespace wheeltap
