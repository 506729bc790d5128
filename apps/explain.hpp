// What a key of a case means, as the schemas say.
#pragma once

#include <string>

namespace wheeltap::apps {

/// Every place of every kind of case whose path ends with `key` ("damage.count.max", "count.max",
/// "max", "/damage/count/max"): its meaning, what may stand there, and its own keys. Throws Failure
/// (usage) where there is none, with the nearest key.
[[nodiscard]] std::string explanation(const std::string& key);

}  // namespace wheeltap::apps
