#include "test/sim/command/control_server.h"

#include <httplib.h>

#include <chrono>
#include <thread>
#include <utility>

#include "test/sim/camera/http_port.h"

namespace soffit::sim {

struct ControlServer::Server {
  httplib::Server http;
  int port = 0;
  std::thread thread;
};

ControlServer::ControlServer(int port, Disturb disturb, Describe describe)
    : server_(std::make_unique<Server>()) {
  server_->http.Post("/disturb", [disturb = std::move(disturb)](const httplib::Request& request,
                                                                httplib::Response& response) {
    const Status status = disturb(request.body.substr(0, request.body.find_last_not_of(" \r\n") + 1));
    response.status = status.ok() ? 200 : 400;
    response.set_content(status.ok() ? "ok\n" : status.error().message + "\n", "text/plain");
  });
  server_->http.Get("/truth",
                    [describe = std::move(describe)](const httplib::Request&, httplib::Response& response) {
                      response.set_content(describe() + "\n", "application/json");
                    });
  server_->port = BindAlone(server_->http, port);
  server_->thread = std::thread([server = server_.get()] { server->http.listen_after_bind(); });
  while (!server_->http.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

ControlServer::~ControlServer() {
  server_->http.stop();
  server_->thread.join();
}

int ControlServer::port() const { return server_->port; }

}  // namespace soffit::sim
