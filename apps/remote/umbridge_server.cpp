#include "apps/remote/umbridge_server.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <semaphore>
#include <thread>

#include "apps/cases/syntax/case_file.hpp"
#include "apps/json_text.hpp"
#include "apps/remote/bounded_server.hpp"

namespace wheeltap::apps {

#ifndef WHEELTAP_WITH_HTTP

void serve_models(const std::vector<ServedModel>& /*models*/, const ServerOptions& /*options*/) {
  throw Failure(Exit::usage, "serve: this wheeltap was built without cpp-httplib");
}

#else

namespace {

using identification::OutsideModel;

/// An error of a request, in the terms of the protocol.
struct Refusal {
  std::string type, message;
};

/// Idle instances of a model.
class Workers {
 public:
  explicit Workers(ServedModel model) : model_(std::move(model)), first_(model_.make()) {
    inputs_ = first_->inputs();
    outputs_ = first_->outputs();
    idle_.push_back(std::move(first_));
  }
  [[nodiscard]] const ServedModel& model() const { return model_; }
  [[nodiscard]] int inputs() const { return inputs_; }
  [[nodiscard]] int outputs() const { return outputs_; }

  template <class Work>
  auto with_one(const Work& work) {
    std::unique_ptr<OutsideModel> worker;
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        worker = std::move(idle_.back());
        idle_.pop_back();
      }
    }
    if (!worker) worker = model_.make();
    auto result = work(*worker);
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(worker));
    return result;
  }

 private:
  ServedModel model_;
  std::unique_ptr<OutsideModel> first_;
  int inputs_ = 0, outputs_ = 0;
  std::mutex mutex_;
  std::vector<std::unique_ptr<OutsideModel> > idle_;
};

std::vector<double> answered_numbers(const Json& from, int size, const char* what) {
  if (!from.is_array() || from.size() != static_cast<std::size_t>(size))
    throw Refusal{"InvalidInput", std::string(what) + " must have " + std::to_string(size) +
                                      " numbers, has " + std::to_string(from.size())};
  std::vector<double> out;
  for (const Json& x : from) {
    if (!x.is_number() || !std::isfinite(x.get<double>()))
      throw Refusal{"InvalidInput", std::string(what) + " must be finite numbers, has " + x.dump()};
    out.push_back(x.get<double>());
  }
  return out;
}

const Json& field(const Json& question, const char* name) {
  if (!question.is_object() || !question.contains(name))
    throw Refusal{"InvalidInput", std::string("\"") + name + "\" is missing"};
  return question[name];
}

/// Reads the vector of inputs of a request; there must be exactly one.
std::vector<double> input_of(const Json& question, const Workers& workers) {
  const Json& input = field(question, "input");
  if (!input.is_array() || input.size() != 1)
    throw Refusal{"InvalidInput", "input must be one vector, in a list"};
  return answered_numbers(input[0], workers.inputs(), "the input");
}

Json evaluated(Workers& workers, const Json& question) {
  const auto x = input_of(question, workers);
  std::vector<double> y(static_cast<std::size_t>(workers.outputs()));
  workers.with_one([&](OutsideModel& model) {
    model.evaluate(x, y);
    return true;
  });
  // JSON has no infinity: the ln of a zero density becomes the lowest finite number.
  for (double& value : y) {
    if (value == -std::numeric_limits<double>::infinity())
      value = std::numeric_limits<double>::lowest();
    if (!std::isfinite(value))
      throw Refusal{"InvalidOutput", "the result is not finite for this input"};
  }
  return {{"output", Json::array({y})}};
}

Json differentiated(Workers& workers, const Json& question) {
  if (!workers.model().has_gradient)
    throw Refusal{"UnsupportedFeature", "this model has no gradient"};
  for (const char* key : {"outWrt", "inWrt"})
    if (field(question, key) != 0)
      throw Refusal{"InvalidInput", std::string(key) + " must be 0: there is only one vector"};
  const auto x = input_of(question, workers);
  const auto sens = answered_numbers(field(question, "sens"), workers.outputs(), "sens");
  std::vector<double> slope(x.size());
  const bool has =
      workers.with_one([&](OutsideModel& model) { return model.gradient(x, sens, slope); });
  if (!has) throw Refusal{"UnsupportedFeature", "the model has no gradient for this input"};
  return {{"output", slope}};
}

class Server {
 public:
  Server(const std::vector<ServedModel>& models, const ServerOptions& options)
      : options_(options), at_work_(std::max(1, options.threads)) {
    for (const ServedModel& model : models) models_.push_back(std::make_unique<Workers>(model));
    server_.set_tcp_nodelay(true);
    server_.set_keep_alive_max_count(std::numeric_limits<int>::max());
    server_.Get("/Info", [this](const httplib::Request&, httplib::Response& response) {
      Json names = Json::array();
      for (const auto& model : models_) names.push_back(model->model().name);
      response.set_content(Json({{"protocolVersion", 1.0}, {"models", names}}).dump(), kType);
    });
    answer("/ModelInfo", [](Workers& model, const Json&) -> Json {
      return {{"support",
               {{"Evaluate", true},
                {"Gradient", model.model().has_gradient},
                {"ApplyJacobian", false},
                {"ApplyHessian", false}}}};
    });
    answer("/InputSizes", [](Workers& model, const Json&) -> Json {
      return {{"inputSizes", Json::array({model.inputs()})}};
    });
    answer("/OutputSizes", [](Workers& model, const Json&) -> Json {
      return {{"outputSizes", Json::array({model.outputs()})}};
    });
    answer("/Evaluate", evaluated);
    answer("/Gradient", differentiated);
    for (const char* missing : {"/ApplyJacobian", "/ApplyHessian"})
      answer(missing, [](Workers&, const Json&) -> Json {
        throw Refusal{"UnsupportedFeature", "is not offered"};
      });
  }

  void run() {
    const int port = options_.port > 0
                         ? (server_.bind_to_port(options_.host, options_.port) ? options_.port : -1)
                         : server_.bind_to_any_port(options_.host);
    if (port <= 0)
      throw Failure(Exit::cannot_create,
                    "--port: " + options_.host +
                        (options_.port > 0 ? ", port " + std::to_string(options_.port) : "") +
                        ": not available: another program uses it, or this machine does not have "
                        "this address");
    std::jthread watch([this](const std::stop_token& done) {
      while (!done.stop_requested() && !(options_.stop && options_.stop()))
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      server_.stop();
    });
    if (options_.ready) options_.ready(port);
    server_.listen_after_bind();
  }

 private:
  static constexpr const char* kType = "application/json";
  using Answer = std::function<Json(Workers&, const Json&)>;

  void answer(const char* endpoint, const Answer& make) {
    server_.Post(endpoint, [this, make](const httplib::Request&, httplib::Response& response,
                                        const httplib::ContentReader& reader) {
      const auto body = server_.body_of(reader);
      if (!body)
        return refuse(response,
                      {"InvalidInput", "the request is incomplete or has more than " +
                                           std::to_string(kLargestAnswer) + " bytes"},
                      413);
      try {
        response.set_content(make_answer(*body, make).dump(), kType);
      } catch (const Refusal& refusal) {
        refuse(response, refusal, 400);
      } catch (const std::invalid_argument& error) {
        refuse(response, {"InvalidInput", error.what()}, 400);
      } catch (const std::exception& error) {
        refuse(response, {"InvalidOutput", error.what()}, 500);
      }
    });
  }

  Json make_answer(const std::string& body, const Answer& make) {
    const Json question = parse_answer(body);
    if (question.is_discarded()) throw Refusal{"InvalidInput", "the request is not JSON"};
    const Json& name = field(question, "name");
    const auto found = std::ranges::find_if(
        models_, [&](const auto& model) { return name == model->model().name; });
    if (found == models_.end()) throw Refusal{"ModelNotFound", "unknown model " + name.dump()};
    // There may be many connections: limit the number of simultaneous evaluations.
    struct Leave {
      std::counting_semaphore<>& of;
      ~Leave() { of.release(); }
    };
    at_work_.acquire();
    const Leave leave{at_work_};
    return make(**found, question);
  }

  static void refuse(httplib::Response& response, const Refusal& refusal, int status) {
    response.status = status;
    response.set_content(Json({{"error", {{"type", refusal.type}, {"message", refusal.message}}}})
                             .dump(-1, ' ', false, Json::error_handler_t::replace),
                         kType);
  }

  ServerOptions options_;
  std::vector<std::unique_ptr<Workers> > models_;
  std::counting_semaphore<> at_work_;
  BoundedServer server_{{.body = kLargestAnswer}};
};

}  // namespace

void serve_models(const std::vector<ServedModel>& models, const ServerOptions& options) {
  Server(models, options).run();
}

#endif

}  // namespace wheeltap::apps
