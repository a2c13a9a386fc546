#include "studies/explore/http_server.h"

#include <httplib.h>
#include <netinet/tcp.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include "sim/error.h"

namespace marti::studies::explore {

namespace {

constexpr std::size_t threads = 16;
constexpr const char* any_path = ".*";
constexpr const char* policy = "Content-Security-Policy";

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

// Nothing of the page may be kept, shown inside another page, or taken for another type, and no other page
// learns its address.
const httplib::Headers& headers_of_all() {
  static const httplib::Headers headers = {{policy, "default-src 'none'; frame-ancestors 'none'"},
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
  if (!made.policy.empty()) {
    response.headers.erase(policy);
    response.set_header(policy, made.policy);
  }
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

using Clock = std::chrono::steady_clock;

// A request must have come, and its answer have been taken, in so much time; the page is on this computer.
constexpr std::chrono::seconds for_request(2);
constexpr std::chrono::seconds for_answer(10);
// When the server ends, an answer that is under way is given this long.
constexpr std::chrono::milliseconds for_last_answer(500);
// So long a connection may wait before it looks whether the server ends.
constexpr std::chrono::milliseconds between_looks(100);
constexpr std::size_t most_head_bytes = 32 * 1024;

// A connection whose request may be neither endless nor slow.
class Connection : public httplib::Stream {
 public:
  Connection(socket_t socket, std::size_t most_bytes, const std::atomic<bool>& ending)
      : socket_(socket), left_(most_head_bytes + 2 * most_bytes), ending_(ending) {}
  ~Connection() override {
    shutdown(socket_, SHUT_RDWR);
    close(socket_);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  [[nodiscard]] bool is_readable() const override { return begin_ < end_ || ready(POLLIN, between_looks); }
  [[nodiscard]] bool is_writable() const override { return ready(POLLOUT, between_looks); }

  ssize_t read(char* into, std::size_t size) override {
    if (begin_ == end_ && !fill()) {
      return -1;
    }
    const std::size_t given = std::min(size, end_ - begin_);
    std::copy_n(buffer_.data() + begin_, given, into);
    begin_ += given;
    return static_cast<ssize_t>(given);
  }
  ssize_t write(const char* from, std::size_t size) override {
    if (!answer_until_) {
      answer_until_ = Clock::now() + for_answer;
    }
    while (!ready(POLLOUT, between_looks)) {
      const Clock::time_point now = Clock::now();
      if (ending_) {
        answer_until_ = std::min(*answer_until_, now + for_last_answer);
      }
      if (now >= *answer_until_) {
        return -1;
      }
    }
    return send(socket_, from, size, MSG_DONTWAIT | MSG_NOSIGNAL);
  }

  void get_remote_ip_and_port(std::string& ip, int& port) const override { get_local_ip_and_port(ip, port); }
  void get_local_ip_and_port(std::string& ip, int& port) const override {
    ip = "127.0.0.1";
    port = 0;
  }
  [[nodiscard]] socket_t socket() const override { return socket_; }

 private:
  [[nodiscard]] bool ready(short what, std::chrono::milliseconds most) const {
    pollfd asked{socket_, what, 0};
    return poll(&asked, 1, static_cast<int>(most.count())) > 0;
  }
  // Whether more of the request has come.
  bool fill() {
    do {
      if (ending_ || Clock::now() >= request_until_) {
        return false;
      }
    } while (!ready(POLLIN, between_looks));
    const ssize_t came = recv(socket_, buffer_.data(), std::min(buffer_.size(), left_), MSG_DONTWAIT);
    if (came <= 0) {
      return false;
    }
    begin_ = 0;
    end_ = static_cast<std::size_t>(came);
    left_ -= end_;
    return true;
  }

  socket_t socket_;
  std::size_t left_;  // bytes that the request may still have
  const std::atomic<bool>& ending_;
  std::array<char, 4096> buffer_{};
  std::size_t begin_ = 0;  // of what is in the buffer
  std::size_t end_ = 0;
  Clock::time_point request_until_ = Clock::now() + for_request;
  std::optional<Clock::time_point> answer_until_;  // set when the answer begins
};

// cpp-httplib's server on such connections.
class Server : public httplib::Server {
 public:
  // cpp-httplib lets five connections wait to be taken; one more is tried again by its client after a second.
  void let_many_wait() { ::listen(svr_sock_, SOMAXCONN); }
  // A connection on which nothing has come yet keeps no thread: the system hands over those with a request.
  void leave_silent_ones() {
    const int seconds = 60;
    setsockopt(svr_sock_, IPPROTO_TCP, TCP_DEFER_ACCEPT, &seconds, sizeof(seconds));
  }
  void end() {
    ending_ = true;
    stop();
  }

 private:
  bool process_and_close_socket(socket_t socket) override {
    Connection connection(socket, payload_max_length_, ending_);
    bool closed = false;
    return process_request(connection, true, closed, nullptr);
  }

  std::atomic<bool> ending_ = false;
};

class Httplib : public HttpServer {
 public:
  Httplib() {
    server_.new_task_queue = [] { return new httplib::ThreadPool(threads); };
    server_.set_tcp_nodelay(true);
    server_.set_default_headers(headers_of_all());
    // The default lets another process take the same port.
    server_.set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    });
  }

  int bind(int port) override {
    const int asked = port;
    if (port == 0) {
      port = server_.bind_to_any_port("127.0.0.1");
    } else if (!server_.bind_to_port("127.0.0.1", port)) {
      port = -1;
    }
    if (port < 0) {
      throw sim::UserError("explore: port " + std::to_string(asked) +
                           " cannot be had; another program may use it (--port 0 takes a free one)");
    }
    server_.let_many_wait();
    server_.leave_silent_ones();
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
    server_.end();
  }

 private:
  Server server_;
  std::atomic<bool> ended_ = false;
};

}  // namespace

}  // namespace marti::studies::explore

marti::studies::explore::HttpServer* marti_http_server() { return new marti::studies::explore::Httplib(); }
