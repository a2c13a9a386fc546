// What a request may have of an exploration: the page's files and answers of the session, nothing else.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "studies/explore/http_server.h"
#include "studies/explore/session.h"
#include "studies/explore/turns.h"

namespace marti::studies::explore {

/// The most bytes of a request's body.
inline constexpr std::size_t most_body_bytes = 64 * 1024;

/// 128 random bits in hexadecimal digits.
[[nodiscard]] std::string random_token();

/// Paths are below /TOKEN/; of every other one nothing is said but 404. A request must name this computer as
/// its host, so that no other name that leads here serves, and must come from this page or from no page.
class ExploreService : public HttpService {
 public:
  /// `session` must outlive the object.
  ExploreService(const Session& session, std::string token, int port);

  [[nodiscard]] std::optional<HttpResponse> answer_head(const HttpHead& head) override;
  [[nodiscard]] HttpResponse answer(const HttpHead& head, const std::string& body) override;

  /// "http://127.0.0.1:PORT/TOKEN/".
  [[nodiscard]] std::string address() const;

  /// Waits until the page has asked for the end, `seconds` at most; 0: without limit.
  void wait_for_end(double seconds);

 private:
  [[nodiscard]] bool is_own(const HttpHead& head) const;
  [[nodiscard]] std::optional<std::string> below_token(const std::string& path) const;
  [[nodiscard]] std::optional<HttpResponse> file(const std::string& name) const;
  using Simulate = std::function<HttpResponse(const Settings& settings, sim::WorkMeter* meter)>;
  // What `what` gives when it is its turn.
  [[nodiscard]] HttpResponse simulate(const std::string& body, const Simulate& what);

  const Session& session_;
  std::string token_;
  int port_;
  Turns turns_;
  std::mutex mutex_;
  std::condition_variable end_asked_;
  bool end_ = false;
};

}  // namespace marti::studies::explore
