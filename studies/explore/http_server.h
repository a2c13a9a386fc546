// What marti explore asks of cpp-httplib. The functions are in a shared library of their own,
// marti_http_server.so, which is loaded by this command alone: cpp-httplib brings the libraries of TLS and of
// compression, which no other command needs.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace marti::studies::explore {

/// A request without its body. Of a header that came several times all values are here.
struct HttpHead {
  std::string method;
  std::string path;  ///< without what follows a '?'
  std::vector<std::string> hosts;
  std::vector<std::string> origins;
  std::vector<std::string> content_types;
};

struct HttpResponse {
  int status = 200;
  std::string content_type{};
  std::string body{};
  std::string policy{};  ///< Content-Security-Policy; empty: nothing is loaded, and no page has it in a frame
};

/// Answers requests, several at a time. Its functions must not throw.
class HttpService {
 public:
  HttpService() = default;
  virtual ~HttpService() = default;
  HttpService(const HttpService&) = delete;
  HttpService& operator=(const HttpService&) = delete;

  /// The answer to a request that needs no body, or that is refused without reading it; std::nullopt for a
  /// POST whose body is wanted.
  [[nodiscard]] virtual std::optional<HttpResponse> answer_head(const HttpHead& head) = 0;
  /// The answer to a POST.
  [[nodiscard]] virtual HttpResponse answer(const HttpHead& head, const std::string& body) = 0;
};

class HttpServer {
 public:
  HttpServer() = default;
  virtual ~HttpServer() = default;
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Takes a port of 127.0.0.1, a free one for 0, and returns it. Throws UserError when it cannot be had.
  virtual int bind(int port) = 0;
  /// Answers until stop() is called, which may be before. Each response ends its connection, so that nothing
  /// in a body that was not read is taken for a request; a body longer than `most_bytes` has status 413. A
  /// connection whose request does not come within seconds, or does not end, is closed.
  virtual void serve(HttpService& service, std::size_t most_bytes) = 0;
  /// Has serve() end when the requests that it works on are answered, without waiting for requests that have
  /// not come or for answers that are not taken. From any thread.
  virtual void stop() = 0;
};

/// Loads the library. Throws UserError when that fails.
[[nodiscard]] std::unique_ptr<HttpServer> make_http_server();

}  // namespace marti::studies::explore

/// The one function that marti_http_server.so exports. The caller owns the server.
extern "C" marti::studies::explore::HttpServer* marti_http_server();
