// Python functions as likelihoods of the reversible-jump engine.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "apps/runs/problem_run.hpp"
#include "apps/runs/running.hpp"
#include "python/bindings.hpp"
#include "python/errors.hpp"
#include "python/job.hpp"
#include "python/run.hpp"
#include "python/run_options.hpp"

namespace wheeltap::python {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// The likelihood of a model: maps an (n, d) array to n log likelihoods or, if `batch` is false,
/// a vector of d values to one log likelihood.
struct Function {
  std::string model;
  py::object function;
  bool batch = true;
};

/// Holds the GIL during each call only.
class PythonLikelihood : public inference::Likelihood {
 public:
  /// Both arguments must outlive this object.
  PythonLikelihood(const inference::ModelSpace& space, const std::vector<Function>& functions)
      : space_(space), functions_(functions) {}

  double log_likelihood(int model, std::span<const double> x) override {
    double value = 0.0;
    log_likelihoods(model, x, {&value, 1});
    return value;
  }

  void log_likelihoods(int model, std::span<const double> xs, std::span<double> out) override {
    const Function& of = functions_[static_cast<std::size_t>(model)];
    const auto n = static_cast<py::ssize_t>(out.size());
    const auto d = static_cast<py::ssize_t>(space_[model].dimension);
    const py::gil_scoped_acquire held;
    if (of.batch) {
      // a copy, because the function may keep it
      const py::array_t<double> x({n, d}, xs.data());
      const Array values = converted(of, of.function(x));
      if (values.ndim() != 1 || values.shape(0) != n)
        throw py::value_error("log_likelihood of \"" + of.model + "\": must return " +
                              std::to_string(n) + " numbers for " + std::to_string(n) +
                              " rows, returned an array of " + std::to_string(values.size()) +
                              " in " + std::to_string(values.ndim()) + " dimensions");
      std::copy_n(values.data(), out.size(), out.begin());
      return;
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
      const py::array_t<double> x(d, xs.data() + static_cast<py::ssize_t>(i) * d);
      out[i] = number(of, of.function(x));
    }
  }

 private:
  static double number(const Function& of, const py::object& returned) {
    try {
      return returned.cast<double>();
    } catch (const py::cast_error&) {
      PyErr_Clear();
      throw py::type_error("log_likelihood of \"" + of.model +
                           "\": must return one number, returned " + described(returned));
    }
  }

  static Array converted(const Function& of, const py::object& returned) {
    Array values = Array::ensure(returned);
    if (values) return values;
    PyErr_Clear();
    throw py::type_error("log_likelihood of \"" + of.model +
                         "\": must return an array of numbers, returned " + described(returned));
  }

  /// Description of a result for messages: "str", "ndarray of shape (50,)".
  static std::string described(const py::object& returned) {
    auto text = py::str(py::type::of(returned).attr("__name__")).cast<std::string>();
    if (py::hasattr(returned, "shape"))
      text += " of shape " + py::str(returned.attr("shape")).cast<std::string>();
    return text;
  }

  const inference::ModelSpace& space_;
  const std::vector<Function>& functions_;
};

std::vector<Function> functions_of(const apps::ProblemFile& parsed, const py::list& functions,
                                   const std::vector<bool>& batch) {
  std::vector<Function> out;
  for (std::size_t m = 0; m < batch.size(); ++m)
    out.push_back({parsed.space->models()[m].name, functions[m], batch[m]});
  return out;
}

/// Converts {name: quantile function} from Python.
std::vector<apps::QuantilePrior> quantile_priors(const py::dict& quantiles) {
  std::vector<apps::QuantilePrior> out;
  for (const auto& [key, function] : quantiles) {
    out.push_back({key.cast<std::string>(), [f = py::handle(function)](std::vector<double>& u) {
                     const py::gil_scoped_acquire held;
                     const auto n = static_cast<py::ssize_t>(u.size());
                     const Array x = Array::ensure(f(py::array_t<double>(n, u.data())));
                     if (!x || x.size() != n)
                       throw py::value_error("a quantile function must return one number for each");
                     std::copy_n(x.data(), u.size(), u.begin());
                   }});
  }
  return out;
}

/// Owns everything that a likelihood refers to.
class Called {
 public:
  Called(apps::ProblemFile parsed, const py::list& functions, const std::vector<bool>& batch)
      : parsed_(std::move(parsed)), functions_(functions_of(parsed_, functions, batch)) {}

  Array operator()(int model, const Array& rows) {
    const inference::ModelSpace& space = *parsed_.space;
    if (model < 0 || model >= space.size())
      throw std::invalid_argument("model = " + std::to_string(model) + ", must be from 0 to " +
                                  std::to_string(space.size() - 1));
    if (rows.ndim() != 2 || rows.shape(1) != space[model].dimension)
      throw std::invalid_argument("rows: must be an (n, " + std::to_string(space[model].dimension) +
                                  ") array");
    Array out(rows.shape(0));
    PythonLikelihood(space, functions_)
        .log_likelihoods(model, {rows.data(), static_cast<std::size_t>(rows.size())},
                         {out.mutable_data(), static_cast<std::size_t>(out.size())});
    return out;
  }

 private:
  apps::ProblemFile parsed_;
  std::vector<Function> functions_;
};

std::shared_ptr<Run> sample(const std::string& text, const py::list& functions,
                            const std::vector<bool>& batch, const py::dict& quantiles,
                            const py::dict& said, const py::object& progress) {
  RunOptions options = run_options(said);
  options.common.case_path = "sample";
  return guarded("sample", [&] {
    static_cast<void>(apps::evidence_methods(options.sampling.evidence));
    const auto parsed = std::make_shared<const apps::ProblemFile>(
        apps::parse_problem(case_of("sample", py::str(text), {})));
    const std::vector<Function> of = functions_of(*parsed, functions, batch);
    const inference::Problem problem = {
        .space = *parsed->space,
        .likelihood = [&] { return std::make_unique<PythonLikelihood>(*parsed->space, of); }};
    const std::vector<apps::QuantilePrior> priors = quantile_priors(quantiles);
    std::shared_ptr<Run> out;
    watched(progress, [&](Job& job) {
      JobWatch watch(job);
      out = std::make_shared<Run>(Run{
          apps::sample_problem(parsed, problem, options.common, options.sampling, watch, priors),
          watch.lines()});
    });
    return out;
  });
}

}  // namespace

void bind_engine(py::module_& m) {
  m.def("sample", &sample, py::arg("problem"), py::arg("functions"), py::arg("batch"),
        py::arg("quantiles"), py::arg("options"), py::arg("progress"));
  // The engine's calls, callable from Python for bench/python/likelihood_bench.py.
  py::class_<Called>(m, "Likelihood", "The user's functions, as the engine calls them.")
      .def(py::init([](const std::string& text, const py::list& functions,
                       const std::vector<bool>& batch) {
             return guarded("sample", [&] {
               return std::make_unique<Called>(
                   apps::parse_problem(case_of("sample", py::str(text), {})), functions, batch);
             });
           }),
           py::arg("problem"), py::arg("functions"), py::arg("batch"))
      .def("__call__", &Called::operator(), py::arg("model"), py::arg("rows"));
}

}  // namespace wheeltap::python
