#include "studies/explore/explore_service.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <exception>
#include <nlohmann/json.hpp>
#include <random>
#include <string_view>
#include <utility>

namespace marti::studies::explore {

namespace {

using Json = nlohmann::ordered_json;

// With its character set cpp-httplib does not know the type as one that it should compress.
constexpr const char* json_type = "application/json; charset=utf-8";

constexpr const char* html_type = "text/html; charset=utf-8";

HttpResponse json_response(std::string json) { return {200, json_type, std::move(json)}; }

HttpResponse nothing(int status) { return {.status = status}; }

// To a request whose place a newer one takes. No status of an error, which browsers would report.
constexpr int superseded = 204;

struct Request {
  Settings settings;
  Asker asker = Asker::reader;
};

// std::nullopt for what the page does not send.
std::optional<Request> parse(const std::string& body) {
  const Json json = Json::parse(body, nullptr, false);
  if (!json.is_object() || !json.contains("settings") || !json["settings"].is_object()) {
    return std::nullopt;
  }
  Request request;
  for (const auto& [key, value] : json["settings"].items()) {
    if (!value.is_string()) {
      return std::nullopt;
    }
    request.settings.emplace_back(key, value.get<std::string>());
  }
  if (const auto background = json.find("background"); background != json.end()) {
    if (!background->is_boolean()) {
      return std::nullopt;
    }
    request.asker = background->get<bool>() ? Asker::background : Asker::reader;
  }
  return request;
}

// Takes equally long wherever the texts differ.
bool equal_texts(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

bool is_json(const HttpHead& head) {
  return head.content_types.size() == 1 && (head.content_types[0] == "application/json" ||
                                            head.content_types[0].starts_with("application/json;"));
}

}  // namespace

std::string random_token() {
  std::random_device random;
  std::string token;
  for (int i = 0; i < 4; ++i) {
    token += fmt::format("{:08x}", random());
  }
  return token;
}

ExploreService::ExploreService(const Session& session, std::string token, int port)
    : session_(session), token_(std::move(token)), port_(port) {}

std::string ExploreService::address() const { return fmt::format("http://127.0.0.1:{}/{}/", port_, token_); }

bool ExploreService::is_own(const HttpHead& head) const {
  // At port 80 clients leave the port out.
  const std::string port = port_ == 80 ? "" : fmt::format(":{}", port_);
  const std::array<std::string, 2> hosts = {"127.0.0.1" + port, "localhost" + port};
  return head.hosts.size() == 1 && std::ranges::find(hosts, head.hosts[0]) != hosts.end() &&
         (head.origins.empty() || (head.origins.size() == 1 && head.origins[0] == "http://" + head.hosts[0]));
}

std::optional<std::string> ExploreService::below_token(const std::string& path) const {
  const std::size_t end = path.find('/', 1);
  if (!path.starts_with('/') || end == std::string::npos ||
      !equal_texts(std::string_view(path).substr(1, end - 1), token_)) {
    return std::nullopt;
  }
  return path.substr(end + 1);
}

std::optional<HttpResponse> ExploreService::file(const std::string& name) const {
  if (name.empty()) {
    // What the page may do beside it says itself.
    return HttpResponse{200, html_type, session_.page(), "frame-ancestors 'none'"};
  }
  if (name == "keys") {
    return json_response(session_.keys());
  }
  if (name == "progress") {
    const sim::WorkMeter::State state = turns_.state();
    return json_response(
        Json({{"part", state.part}, {"unit", state.unit}, {"done", state.done}, {"of", state.of}}).dump());
  }
  return std::nullopt;
}

std::optional<HttpResponse> ExploreService::answer_head(const HttpHead& head) {
  if (!is_own(head)) {
    return nothing(403);
  }
  const std::optional<std::string> name = below_token(head.path);
  if (!name) {
    return nothing(404);
  }
  if (head.method == "GET") {
    return file(*name).value_or(nothing(404));
  }
  constexpr std::array<std::string_view, 5> posts = {"time", "helps", "model", "report", "end"};
  if (head.method != "POST" || std::ranges::find(posts, *name) == posts.end()) {
    return nothing(404);
  }
  if (!is_json(head)) {
    return nothing(415);
  }
  return std::nullopt;
}

HttpResponse ExploreService::answer(const HttpHead& head, const std::string& body) {
  const std::string name = below_token(head.path).value_or("");
  try {
    if (name == "time") {
      return simulate(body, [&](const Settings& settings, sim::WorkMeter* meter) {
        return json_response(session_.shown(settings, helps::Measuring::none, meter));
      });
    }
    if (name == "helps") {
      return simulate(body, [&](const Settings& settings, sim::WorkMeter* meter) {
        return json_response(session_.shown(settings, helps::Measuring::within_budget, meter));
      });
    }
    if (name == "model") {  // beside the simulation whose answer it stands for
      const std::optional<Request> request = parse(body);
      return request ? json_response(session_.modelled(request->settings)) : nothing(400);
    }
    if (name == "report") {
      return simulate(body, [&](const Settings& settings, sim::WorkMeter* meter) {
        std::string refused;
        std::optional<std::string> page = session_.report(settings, refused, meter);
        return page ? HttpResponse{200, html_type, std::move(*page)} : json_response(std::move(refused));
      });
    }
  } catch (const sim::Stopped&) {
    return nothing(superseded);
  } catch (const std::exception& error) {
    const Json json = {{"error", "internal error: " + std::string(error.what())}, {"key", nullptr}};
    return {500, json_type, json.dump(-1, ' ', false, Json::error_handler_t::replace)};
  }
  const std::lock_guard lock(mutex_);
  end_ = true;
  end_asked_.notify_all();
  return nothing(204);
}

HttpResponse ExploreService::simulate(const std::string& body, const Simulate& what) {
  const std::optional<Request> request = parse(body);
  if (!request) {
    return nothing(400);
  }
  const std::optional<Turns::Turn> turn = turns_.take(request->asker);
  if (!turn) {
    return nothing(superseded);
  }
  return what(request->settings, &turn->meter());
}

void ExploreService::wait_for_end(double seconds) {
  std::unique_lock lock(mutex_);
  if (seconds > 0) {
    end_asked_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return end_; });
  } else {
    end_asked_.wait(lock, [this] { return end_; });
  }
  turns_.stop();
}

}  // namespace marti::studies::explore
