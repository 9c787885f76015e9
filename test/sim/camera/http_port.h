#pragma once

namespace httplib {
class Server;
}

namespace soffit::sim {

/// Binds an HTTP server to a port of 127.0.0.1 that no other program has; 0: to a free one.
///
/// @return  The port.
/// @throws std::runtime_error  it cannot be had.
int BindAlone(httplib::Server& http, int port);

}  // namespace soffit::sim
