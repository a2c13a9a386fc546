#include "studies/explore/explore.h"

#include <cmath>
#include <memory>
#include <optional>
#include <thread>

#include "sim/error.h"
#include "studies/explore/explore_service.h"
#include "studies/explore/http_server.h"
#include "studies/explore/open_page.h"
#include "studies/explore/session.h"
#include "studies/progress/progress_line.h"

namespace marti::studies::explore {

namespace {

// Serves while it lives.
class Serving {
 public:
  Serving(HttpServer& server, HttpService& service)
      : server_(server), thread_([&] { server.serve(service, most_body_bytes); }) {}
  ~Serving() {
    server_.stop();
    thread_.join();
  }
  Serving(const Serving&) = delete;
  Serving& operator=(const Serving&) = delete;

 private:
  HttpServer& server_;
  std::thread thread_;
};

}  // namespace

void explore_command(const ExploreArguments& arguments, void (*print)(const std::string&)) {
  if (!std::isfinite(arguments.seconds)) {
    throw sim::UserError("--for: must be a number of seconds");
  }
  const std::unique_ptr<HttpServer> server = make_http_server();
  const int port = server->bind(arguments.port);  // before the frame is traced, which may take long
  sim::WorkMeter meter;
  std::optional<progress::ShownMeter> shown(std::in_place, meter);
  const Session session(arguments.config, arguments.assignments, &meter);
  shown.reset();  // before anything is printed
  ExploreService service(session, random_token(), port);
  const Serving serving(*server, service);
  print(service.address() + "\n");
  if (!arguments.no_browser && has_screen()) {
    open_page(service.address());
  }
  service.wait_for_end(arguments.seconds);
}

}  // namespace marti::studies::explore
