// The server of an exploration over a real socket: who is answered, and that all others learn nothing.
#include <gtest/gtest.h>
#include <httplib.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "studies/explore/explore_service.h"
#include "studies/explore/http_server.h"
#include "studies/explore/session.h"
#include "studies/report/plots/vega_bundle.h"
#include "tests/support/temporary_directory.h"

namespace marti::studies {

using namespace explore;
using namespace helps;
using namespace report;

namespace {

const Session& session() {
  static const test::TemporaryDirectory directory;
  static const Session session = [] {
    const std::filesystem::path file = directory.path() / "served.toml";
    std::ofstream(file) << "[scene]\nsource = \"tetra:2\"\n[image]\nwidth = 8\nheight = 8\n";
    return Session(file, {});
  }();
  return session;
}

class Served : public testing::Test {
 protected:
  Served()
      : server_(make_http_server()),
        port_(server_->bind(0)),
        service_(session(), token_, port_),
        thread_([this] { server_->serve(service_, most_body_bytes); }),
        client_("127.0.0.1", port_) {}
  ~Served() override {
    server_->stop();
    thread_.join();
  }

  [[nodiscard]] std::string path(const std::string& name) const { return "/" + token_ + "/" + name; }
  [[nodiscard]] std::string host() const { return "127.0.0.1:" + std::to_string(port_); }
  [[nodiscard]] int post(const std::string& name, const std::string& body,
                         const httplib::Headers& headers = {}, const char* type = "application/json") {
    return status(client_.Post(path(name), headers, body, type));
  }
  // Checks that a refusal says nothing, and that no answer lets another page in.
  static int status(const httplib::Result& result) {
    if (!result) {
      return -1;
    }
    EXPECT_FALSE(result->has_header("Access-Control-Allow-Origin"));
    EXPECT_EQ(result->get_header_value("Cross-Origin-Resource-Policy"), "same-origin");
    EXPECT_EQ(result->get_header_value("Referrer-Policy"), "no-referrer");
    EXPECT_EQ(result->get_header_value_count("Content-Security-Policy"), 1U);
    EXPECT_NE(result->get_header_value("Content-Security-Policy").find("frame-ancestors 'none'"),
              std::string::npos);
    if (result->status >= 400) {
      EXPECT_EQ(result->body, "");
    }
    return result->status;
  }
  [[nodiscard]] int connected() const {
    const int connection = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port_));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    return connection;
  }
  // All that the server sends for these bytes, until it closes the connection.
  [[nodiscard]] std::string raw(const std::string& bytes) const {
    const int connection = connected();
    EXPECT_EQ(send(connection, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
    std::string answer;
    std::array<char, 4096> part{};
    for (ssize_t read = 0; (read = recv(connection, part.data(), part.size(), 0)) > 0;) {
      answer.append(part.data(), static_cast<std::size_t>(read));
    }
    close(connection);
    return answer;
  }

  const std::string token_ = random_token();
  std::unique_ptr<HttpServer> server_;
  int port_;
  ExploreService service_;
  std::thread thread_;
  httplib::Client client_;
};

const std::string machine = R"({"settings": {"machine.nodes": "2"}})";

TEST_F(Served, ThePageAndItsAnswers) {
  const auto page = client_.Get(path(""));
  ASSERT_EQ(status(page), 200);
  EXPECT_EQ(page->body, session().page());
  EXPECT_EQ(page->get_header_value("Content-Type"), "text/html; charset=utf-8");
  // It names each of its scripts, and may ask nobody but this server.
  EXPECT_NE(
      page->body.find("<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src "
                      "data:; base-uri 'none'; form-action 'none'; style-src 'sha256-"),
      std::string::npos);
  EXPECT_NE(page->body.find("; connect-src 'self'; script-src 'sha256-"), std::string::npos);
  const auto keys = client_.Get(path("keys"));
  EXPECT_EQ(keys->body, session().keys());
  EXPECT_EQ(keys->get_header_value("Content-Security-Policy"), "default-src 'none'; frame-ancestors 'none'");
  EXPECT_EQ(client_.Post(path("time"), machine, "application/json")->body,
            session().shown({{"machine.nodes", "2"}}, Measuring::none));
  EXPECT_EQ(client_.Post(path("helps"), machine, "application/json; charset=utf-8")->body,
            session().shown({{"machine.nodes", "2"}}, Measuring::within_budget));
  const auto modelled = client_.Post(path("model"), machine, "application/json");
  EXPECT_EQ(modelled->body, session().modelled({{"machine.nodes", "2"}}));
  EXPECT_EQ(modelled->get_header_value("Content-Type"), "application/json; charset=utf-8");
  EXPECT_EQ(status(client_.Post(path("model"), "[]", "application/json")), 400);
  for (const char* what : {"time", "report"}) {
    const auto json = client_.Post(path(what), R"({"settings": {"machine.nodes": "0"}})", "application/json");
    EXPECT_EQ(json->get_header_value("Content-Type"), "application/json; charset=utf-8") << what;
  }
  const auto refused =
      client_.Post(path("time"), R"({"settings": {"machine.nodes": "0"}})", "application/json");
  EXPECT_EQ(refused->status, 200);
  EXPECT_EQ(nlohmann::json::parse(refused->body)["key"], "machine.nodes");
}

TEST_F(Served, NothingWithoutTheToken) {
  const std::string other = (token_[0] == '0' ? "1" : "0") + token_.substr(1);
  for (const std::string& wrong :
       {std::string("/"), std::string("/keys"), "/" + token_, "/" + other + "/", "/" + token_ + "0/",
        "/" + token_.substr(1) + "/", std::string("//"), "/x" + path(""), std::string("/favicon.ico")}) {
    EXPECT_EQ(status(client_.Get(wrong)), 404) << wrong;
    EXPECT_EQ(status(client_.Post(wrong, machine, "application/json")), 404) << wrong;
  }
}

TEST_F(Served, NoOtherFile) {
  for (const char* name :
       {"../", "../../etc/passwd", "%2e%2e/%2e%2e/etc/passwd", "/etc/passwd", "page.html", "state.js",
        "keys/", "KEYS", "time", "served.toml", "main.js/", "main.js%00.html"}) {
    EXPECT_EQ(status(client_.Get(path(name))), 404) << name;
  }
}

TEST_F(Served, OnlyGetAndPost) {
  EXPECT_EQ(status(client_.Put(path("time"), machine, "application/json")), 404);
  EXPECT_EQ(status(client_.Delete(path(""))), 404);
  EXPECT_EQ(status(client_.Options(path("time"))), 404);
  EXPECT_EQ(status(client_.Head(path(""))), 404);
  EXPECT_EQ(status(client_.Post(path("keys"), machine, "application/json")), 404);
}

// A name that leads to this computer by a trick of its name server is another host.
TEST_F(Served, OnlyThisComputerAsHost) {
  const std::string port = std::to_string(port_);
  for (const std::string& wrong : {"evil.example:" + port, std::string("127.0.0.1"), std::string("localhost"),
                                   "127.0.0.1:" + std::to_string(port_ + 1), "127.0.0.1.evil.example:" + port,
                                   "[::1]:" + port, "LOCALHOST.evil:" + port, std::string()}) {
    EXPECT_EQ(status(client_.Get(path(""), {{"Host", wrong}})), 403) << wrong;
    EXPECT_EQ(post("time", machine, {{"Host", wrong}}), 403) << wrong;
  }
  EXPECT_EQ(status(client_.Get(path(""), {{"Host", "localhost:" + port}})), 200);
  const std::string get = "GET " + path("") + " HTTP/1.1\r\n";
  EXPECT_TRUE(raw(get + "\r\n").starts_with("HTTP/1.1 403"));
  EXPECT_TRUE(raw(get + "Host: " + host() + "\r\nHost: evil.example\r\n\r\n").starts_with("HTTP/1.1 403"));
}

TEST_F(Served, OnlyThePageAsOrigin) {
  const std::string port = std::to_string(port_);
  for (const std::string& wrong :
       {std::string("https://evil.example"), std::string("null"), "https://" + host(),
        "http://127.0.0.1:" + std::to_string(port_ + 1), std::string("http://127.0.0.1"),
        "http://localhost:" + port, "http://" + host() + "/"}) {
    EXPECT_EQ(post("time", machine, {{"Origin", wrong}}), 403) << wrong;
    EXPECT_EQ(post("end", "{}", {{"Origin", wrong}}), 403) << wrong;
    EXPECT_EQ(status(client_.Get(path("keys"), {{"Origin", wrong}})), 403) << wrong;
  }
  EXPECT_EQ(post("time", machine, {{"Origin", "http://" + host()}}), 200);
  EXPECT_EQ(post("time", machine, {{"Origin", "http://localhost:" + port}, {"Host", "localhost:" + port}}),
            200);
}

// A form of another page can send these types without being asked for permission.
TEST_F(Served, OnlyJson) {
  for (const char* type :
       {"text/plain", "application/x-www-form-urlencoded", "multipart/form-data; boundary=x",
        "application/jsonp", "text/plain; application/json"}) {
    EXPECT_EQ(post("time", machine, {}, type), 415) << type;
    EXPECT_EQ(post("end", "{}", {}, type), 415) << type;
  }
  EXPECT_TRUE(raw("POST " + path("end") + " HTTP/1.1\r\nHost: " + host() + "\r\nContent-Length: 2\r\n\r\n{}")
                  .starts_with("HTTP/1.1 415"));
}

TEST_F(Served, OnlyBodiesThatThePageSends) {
  for (const std::string& body :
       {std::string(), std::string("{"), std::string("[]"), std::string("{}"),
        std::string(R"({"settings": []})"), std::string(R"({"settings": {"machine.nodes": 2}})"),
        std::string(R"({"settings": {}, "background": 1})"), std::string(60000, '['),
        std::string("{\"settings\": \"\xff\"}")}) {
    EXPECT_EQ(post("time", body), 400) << body.substr(0, 40);
  }
}

TEST_F(Served, NoLongBody) {
  const std::string fits = machine + std::string(most_body_bytes - machine.size(), ' ');
  EXPECT_EQ(post("time", fits), 200);
  EXPECT_EQ(post("time", fits + " "), 413);
  const auto chunks = client_.Post(
      path("time"),
      [&](std::size_t, httplib::DataSink& sink) {
        for (int i = 0; i < 100; ++i) {
          const std::string part(1024, ' ');
          sink.write(part.data(), part.size());
        }
        sink.done();
        return true;
      },
      "application/json");
  // The server may close the connection before all is sent.
  EXPECT_TRUE(status(chunks) == 413 || status(chunks) == -1) << status(chunks);
  EXPECT_EQ(post("time", machine), 200);
}

// A process without the token must not be able to have lines kept for it.
TEST_F(Served, NoEndlessHead) {
  for (const std::string& line : {std::string("X-Long: more\r\n"), std::string(4000, 'x')}) {
    const int connection = connected();
    std::string lines = "GET / HTTP/1.1\r\n";
    while (lines.size() < 64 * 1024) {
      lines += line;
    }
    // More than the two ends of a connection hold.
    bool refused = false;
    for (int i = 0; i < 1024 && !refused; ++i) {
      refused = send(connection, lines.data(), lines.size(), MSG_NOSIGNAL) < 0;
    }
    EXPECT_TRUE(refused);
    close(connection);
  }
  EXPECT_EQ(post("time", machine), 200);
}

TEST_F(Served, NoSlowRequest) {
  // It is refused at last, and its connection closed.
  EXPECT_EQ(raw("GET " + path("") + " HTTP/1.1\r\nHost: ").find("HTTP/1.1 200"), std::string::npos);
  EXPECT_EQ(post("time", machine), 200);
}

// Browsers connect ahead of what they will ask for. Each of these would keep one of the server's threads for
// two seconds, and the client waits five.
TEST_F(Served, ConnectionsOnWhichNothingComesKeepNobodyWaiting) {
  std::vector<int> connections(300);
  for (int& connection : connections) {
    connection = connected();
  }
  EXPECT_EQ(status(client_.Get(path("progress"))), 200);
  for (const int connection : connections) {
    close(connection);
  }
}

// More connections than the server has threads, which would wait for requests for seconds.
TEST_F(Served, TheEndWaitsForNobody) {
  std::vector<int> connections;
  for (int i = 0; i < 20; ++i) {
    connections.push_back(connected());
    EXPECT_EQ(send(connections.back(), "GET", 3, MSG_NOSIGNAL), 3);
  }
  const auto begin = std::chrono::steady_clock::now();
  server_->stop();
  thread_.join();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(1900));
  for (const int connection : connections) {
    close(connection);
  }
  thread_ = std::thread([] {});  // for the destructor
}

TEST_F(Served, SaysHowFarItIs) {
  const auto idle = client_.Get(path("progress"));
  ASSERT_EQ(status(idle), 200);
  EXPECT_EQ(idle->body, R"({"part":"","unit":"","done":0,"of":0})");
}

TEST_F(Served, AReportHasAllMachines) {
  if (!have_vega_scripts()) {
    GTEST_SKIP() << "this build draws no charts";
  }
  EXPECT_EQ(post("time", R"({"settings": {"machine.nodes": "3"}})"), 200);
  const auto page = client_.Post(path("report"), machine, "application/json");
  ASSERT_EQ(status(page), 200);
  EXPECT_EQ(page->get_header_value("Content-Type"), "text/html; charset=utf-8");
  EXPECT_EQ(page->body.find("<!DOCTYPE html>"), 0U);
  for (const char* said : {"machine.nodes = 3", "machine.nodes = 2", "All machines that were simulated"}) {
    EXPECT_NE(page->body.find(said), std::string::npos) << said;
  }
  const auto refused =
      client_.Post(path("report"), R"({"settings": {"machine.nodes": "0"}})", "application/json");
  EXPECT_EQ(nlohmann::json::parse(refused->body)["key"], "machine.nodes");
  EXPECT_EQ(post("report", machine, {{"Origin", "https://evil.example"}}), 403);
}

// What a refused body holds is not taken for the next request.
TEST_F(Served, OneRequestAConnection) {
  const std::string inner = "POST " + path("end") + " HTTP/1.1\r\nHost: " + host() +
                            "\r\nContent-Type: application/json\r\nContent-Length: 2\r\n\r\n{}";
  const std::string answer = raw(
      "POST /guess/time HTTP/1.1\r\nHost: " + host() +
      "\r\nContent-Type: text/plain\r\nContent-Length: " + std::to_string(inner.size()) + "\r\n\r\n" + inner);
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 404"));
  EXPECT_EQ(answer.find("HTTP/1.1", 1), std::string::npos);
  EXPECT_EQ(answer.find("HTTP/1.1 200"), std::string::npos);
}

TEST_F(Served, ThePageMayEndIt) {
  auto ended = std::thread([this] { service_.wait_for_end(0); });
  EXPECT_EQ(post("end", "{}"), 204);
  ended.join();
}

TEST_F(Served, EndsByItselfAfterItsTime) { service_.wait_for_end(0.01); }

TEST_F(Served, APortIsTakenOnce) {
  const std::unique_ptr<HttpServer> second = make_http_server();
  EXPECT_THROW(static_cast<void>(second->bind(port_)), sim::UserError);
}

TEST(Token, IsAnotherOneEachTime) {
  EXPECT_EQ(random_token().size(), 32U);
  EXPECT_NE(random_token(), random_token());
}

}  // namespace
}  // namespace marti::studies
