#include "studies/explore/http_server.h"

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <utility>

#include "sim/error.h"

namespace marti::studies {

namespace {

constexpr std::size_t threads = 16;
constexpr const char* any_path = ".*";

std::vector<std::string> values_of(const httplib::Request& request, const std::string& name) {
  std::vector<std::string> values;
  const auto [begin, end] = request.headers.equal_range(name);
  for (auto header = begin; header != end; ++header) {
    values.push_back(header->second);
  }
  return values;
}

HttpHead head_of(const httplib::Request& request) {
  return {request.method, request.path, values_of(request, "Host"), values_of(request, "Origin"),
          values_of(request, "Content-Type")};
}

// Nothing of the page may be kept, shown inside another page, or taken for another type; it may load only
// what this server gives; and no other page learns its address.
const httplib::Headers& headers_of_all() {
  static const httplib::Headers headers = {
      {"Content-Security-Policy",
       "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; base-uri "
       "'none'; form-action 'none'; frame-ancestors 'none'"},
      {"X-Content-Type-Options", "nosniff"},
      {"X-Frame-Options", "DENY"},
      {"Referrer-Policy", "no-referrer"},
      {"Cross-Origin-Opener-Policy", "same-origin"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Cache-Control", "no-store"}};
  return headers;
}

void put(HttpResponse made, httplib::Response& response) {
  response.status = made.status;
  // cpp-httplib compresses types that begin with "text/", which takes longer than to send them, but not what
  // a provider gives. Answers come from none, because stop() cuts providers off.
  if (made.content_type.starts_with("application/")) {
    response.set_content(made.body, made.content_type);
  } else if (!made.body.empty()) {
    const std::size_t size = made.body.size();
    response.set_content_provider(
        size, made.content_type,
        [body = std::move(made.body)](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
          return sink.write(body.data() + offset, length);
        });
  }
}

class Httplib : public HttpServer {
 public:
  Httplib() {
    server_.new_task_queue = [] { return new httplib::ThreadPool(threads); };
    server_.set_keep_alive_max_count(1);
    server_.set_keep_alive_timeout(2);
    server_.set_tcp_nodelay(true);
    server_.set_default_headers(headers_of_all());
    // The default lets another process take the same port.
    server_.set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    });
  }

  int bind(int port) override {
    if (port == 0) {
      port = server_.bind_to_any_port("127.0.0.1");
    } else if (!server_.bind_to_port("127.0.0.1", port)) {
      port = -1;
    }
    if (port < 0) {
      throw sim::UserError(
          "explore: the port cannot be had; another program may use it (--port 0 takes a free one)");
    }
    return port;
  }

  void serve(HttpService& service, std::size_t most_bytes) override {
    server_.set_payload_max_length(most_bytes);
    server_.set_pre_routing_handler([&service](const httplib::Request& request, httplib::Response& response) {
      std::optional<HttpResponse> answer = service.answer_head(head_of(request));
      if (!answer) {
        return httplib::Server::HandlerResponse::Unhandled;
      }
      put(*std::move(answer), response);
      return httplib::Server::HandlerResponse::Handled;
    });
    server_.Post(any_path,
                 [&service, most_bytes](const httplib::Request& request, httplib::Response& response,
                                        const httplib::ContentReader& read) {
                   // The limit of the server does not hold for a body in chunks.
                   std::string body;
                   const bool whole = read([&](const char* data, std::size_t length) {
                     body.append(data, length);
                     return body.size() <= most_bytes;
                   });
                   if (whole) {
                     put(service.answer(head_of(request), body), response);
                   } else if (body.size() > most_bytes) {
                     response.status = 413;
                   }
                 });
    server_.set_exception_handler([](const httplib::Request&, httplib::Response& response,
                                     const std::exception_ptr&) { response.status = 500; });
    server_.listen_after_bind();
    ended_ = true;
  }

  void stop() override {
    // cpp-httplib forgets a stop that comes before it listens.
    while (!server_.is_running() && !ended_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    server_.stop();
  }

 private:
  httplib::Server server_;
  std::atomic<bool> ended_ = false;
};

}  // namespace

}  // namespace marti::studies

marti::studies::HttpServer* marti_http_server() { return new marti::studies::Httplib(); }
