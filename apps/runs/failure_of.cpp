#include "apps/runs/failure_of.hpp"

#include <new>
#include <system_error>

#include "identification/emulation/outside_model.hpp"
#include "inference/model/target.hpp"
#include "io/file_error.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

Exit exit_of(io::FileError::Kind kind) {
  switch (kind) {
    case io::FileError::Kind::missing:
      return Exit::no_input;
    case io::FileError::Kind::unwritable:
      return Exit::cannot_create;
    default:
      return Exit::bad_input;
  }
}

}  // namespace

Failure failure_of(const std::exception_ptr& thrown, const std::filesystem::path& case_path) {
  // Names, keys and values come from the user: make them one printable line.
  const auto failure = [](Exit exit, const std::string& line) {
    return Failure(exit, io::printable(line));
  };
  try {
    std::rethrow_exception(thrown);
  } catch (const Failure& error) {
    return failure(error.exit(), error.what());
  } catch (const io::FileError& error) {
    return failure(exit_of(error.kind()), error.what());
  } catch (const inference::LikelihoodError& error) {
    return failure(Exit::bad_input, case_path.string() + ": " + error.what());
  } catch (const identification::OutsideModelError& error) {
    return failure(error.kind() == identification::OutsideModelError::Kind::unreachable
                       ? Exit::no_input
                       : Exit::bad_input,
                   case_path.string() + ": /predictor: " + error.what());
  } catch (const std::bad_alloc&) {
    return failure(Exit::bad_input, case_path.string() +
                                        ": needs more memory than the system has (--dry-run "
                                        "estimates the memory of a run)");
  } catch (const std::filesystem::filesystem_error& error) {
    return failure(Exit::no_input, error.path1().string() + ": " + error.code().message());
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::resource_unavailable_try_again) {
      return failure(Exit::bad_input,
                     "cannot start another thread or process: the limit of the system or "
                     "container is reached (see `ulimit -u`)");
    }
    return failure(Exit::internal, std::string("internal fault: ") + error.what());
  } catch (const std::runtime_error& error) {
    // Wrong use of functions throws logic errors; other errors are numerical failures.
    return failure(Exit::bad_input, case_path.string() + ": cannot be computed: " + error.what() +
                                        "; check units and sizes");
  } catch (const std::exception& error) {
    return failure(Exit::internal, std::string("internal fault: ") + error.what());
  }
}

}  // namespace wheeltap::apps
