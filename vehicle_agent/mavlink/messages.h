#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <tuple>

/// The MAVLink messages that we use, each declared once: its id, its name, its fields under their MAVLink
/// names and in wire order (largest type first), extension fields last. All else (offsets, lengths,
/// CRC_EXTRA) is computed from this in codec.h. Units are those of the wire.
/// https://mavlink.io/en/messages/common.html, ardupilotmega.html.
namespace soffit::mavlink {

struct Heartbeat {
  static constexpr std::uint32_t kId = 0;
  static constexpr std::string_view kName = "HEARTBEAT";
  std::uint32_t custom_mode = 0;
  std::uint8_t type = 0;
  std::uint8_t autopilot = 0;
  std::uint8_t base_mode = 0;
  std::uint8_t system_status = 0;
  std::uint8_t mavlink_version = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("custom_mode", m.custom_mode);
    field("type", m.type);
    field("autopilot", m.autopilot);
    field("base_mode", m.base_mode);
    field("system_status", m.system_status);
    field("mavlink_version", m.mavlink_version);
  }
};

struct SysStatus {
  static constexpr std::uint32_t kId = 1;
  static constexpr std::string_view kName = "SYS_STATUS";
  std::uint32_t onboard_control_sensors_present = 0;
  std::uint32_t onboard_control_sensors_enabled = 0;
  std::uint32_t onboard_control_sensors_health = 0;
  std::uint16_t load = 0;             ///< [d%]
  std::uint16_t voltage_battery = 0;  ///< [mV]
  std::int16_t current_battery = 0;   ///< [cA]
  std::uint16_t drop_rate_comm = 0;   ///< [c%]
  std::uint16_t errors_comm = 0;
  std::uint16_t errors_count1 = 0;
  std::uint16_t errors_count2 = 0;
  std::uint16_t errors_count3 = 0;
  std::uint16_t errors_count4 = 0;
  std::int8_t battery_remaining = 0;  ///< [%]
  std::uint32_t onboard_control_sensors_present_extended = 0;
  std::uint32_t onboard_control_sensors_enabled_extended = 0;
  std::uint32_t onboard_control_sensors_health_extended = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("onboard_control_sensors_present", m.onboard_control_sensors_present);
    field("onboard_control_sensors_enabled", m.onboard_control_sensors_enabled);
    field("onboard_control_sensors_health", m.onboard_control_sensors_health);
    field("load", m.load);
    field("voltage_battery", m.voltage_battery);
    field("current_battery", m.current_battery);
    field("drop_rate_comm", m.drop_rate_comm);
    field("errors_comm", m.errors_comm);
    field("errors_count1", m.errors_count1);
    field("errors_count2", m.errors_count2);
    field("errors_count3", m.errors_count3);
    field("errors_count4", m.errors_count4);
    field("battery_remaining", m.battery_remaining);
    field.Extensions();
    field("onboard_control_sensors_present_extended", m.onboard_control_sensors_present_extended);
    field("onboard_control_sensors_enabled_extended", m.onboard_control_sensors_enabled_extended);
    field("onboard_control_sensors_health_extended", m.onboard_control_sensors_health_extended);
  }
};

struct SystemTime {
  static constexpr std::uint32_t kId = 2;
  static constexpr std::string_view kName = "SYSTEM_TIME";
  std::uint64_t time_unix_usec = 0;  ///< [us]
  std::uint32_t time_boot_ms = 0;    ///< [ms]
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("time_unix_usec", m.time_unix_usec);
    field("time_boot_ms", m.time_boot_ms);
  }
};

struct ParamRequestRead {
  static constexpr std::uint32_t kId = 20;
  static constexpr std::string_view kName = "PARAM_REQUEST_READ";
  std::int16_t param_index = 0;
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  std::array<char, 16> param_id{};
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("param_index", m.param_index);
    field("target_system", m.target_system);
    field("target_component", m.target_component);
    field("param_id", m.param_id);
  }
};

struct ParamValue {
  static constexpr std::uint32_t kId = 22;
  static constexpr std::string_view kName = "PARAM_VALUE";
  float param_value = 0;
  std::uint16_t param_count = 0;
  std::uint16_t param_index = 0;
  std::array<char, 16> param_id{};
  std::uint8_t param_type = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("param_value", m.param_value);
    field("param_count", m.param_count);
    field("param_index", m.param_index);
    field("param_id", m.param_id);
    field("param_type", m.param_type);
  }
};

struct ParamSet {
  static constexpr std::uint32_t kId = 23;
  static constexpr std::string_view kName = "PARAM_SET";
  float param_value = 0;
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  std::array<char, 16> param_id{};
  std::uint8_t param_type = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("param_value", m.param_value);
    field("target_system", m.target_system);
    field("target_component", m.target_component);
    field("param_id", m.param_id);
    field("param_type", m.param_type);
  }
};

struct GpsRawInt {
  static constexpr std::uint32_t kId = 24;
  static constexpr std::string_view kName = "GPS_RAW_INT";
  std::uint64_t time_usec = 0;  ///< [us]
  std::int32_t lat = 0;         ///< [degE7]
  std::int32_t lon = 0;         ///< [degE7]
  std::int32_t alt = 0;         ///< [mm]
  std::uint16_t eph = 0;
  std::uint16_t epv = 0;
  std::uint16_t vel = 0;  ///< [cm/s]
  std::uint16_t cog = 0;  ///< [cdeg]
  std::uint8_t fix_type = 0;
  std::uint8_t satellites_visible = 0;
  std::int32_t alt_ellipsoid = 0;  ///< [mm]
  std::uint32_t h_acc = 0;         ///< [mm]
  std::uint32_t v_acc = 0;         ///< [mm]
  std::uint32_t vel_acc = 0;       ///< [mm/s]
  std::uint32_t hdg_acc = 0;       ///< [degE5]
  std::uint16_t yaw = 0;           ///< [cdeg]
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("time_usec", m.time_usec);
    field("lat", m.lat);
    field("lon", m.lon);
    field("alt", m.alt);
    field("eph", m.eph);
    field("epv", m.epv);
    field("vel", m.vel);
    field("cog", m.cog);
    field("fix_type", m.fix_type);
    field("satellites_visible", m.satellites_visible);
    field.Extensions();
    field("alt_ellipsoid", m.alt_ellipsoid);
    field("h_acc", m.h_acc);
    field("v_acc", m.v_acc);
    field("vel_acc", m.vel_acc);
    field("hdg_acc", m.hdg_acc);
    field("yaw", m.yaw);
  }
};

struct Attitude {
  static constexpr std::uint32_t kId = 30;
  static constexpr std::string_view kName = "ATTITUDE";
  std::uint32_t time_boot_ms = 0;  ///< [ms]
  float roll = 0;                  ///< [rad]
  float pitch = 0;                 ///< [rad]
  float yaw = 0;                   ///< [rad]
  float rollspeed = 0;             ///< [rad/s]
  float pitchspeed = 0;            ///< [rad/s]
  float yawspeed = 0;              ///< [rad/s]
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("time_boot_ms", m.time_boot_ms);
    field("roll", m.roll);
    field("pitch", m.pitch);
    field("yaw", m.yaw);
    field("rollspeed", m.rollspeed);
    field("pitchspeed", m.pitchspeed);
    field("yawspeed", m.yawspeed);
  }
};

struct AttitudeQuaternion {
  static constexpr std::uint32_t kId = 31;
  static constexpr std::string_view kName = "ATTITUDE_QUATERNION";
  std::uint32_t time_boot_ms = 0;  ///< [ms]
  float q1 = 0;
  float q2 = 0;
  float q3 = 0;
  float q4 = 0;
  float rollspeed = 0;   ///< [rad/s]
  float pitchspeed = 0;  ///< [rad/s]
  float yawspeed = 0;    ///< [rad/s]
  std::array<float, 4> repr_offset_q{};
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("time_boot_ms", m.time_boot_ms);
    field("q1", m.q1);
    field("q2", m.q2);
    field("q3", m.q3);
    field("q4", m.q4);
    field("rollspeed", m.rollspeed);
    field("pitchspeed", m.pitchspeed);
    field("yawspeed", m.yawspeed);
    field.Extensions();
    field("repr_offset_q", m.repr_offset_q);
  }
};

struct LocalPositionNed {
  static constexpr std::uint32_t kId = 32;
  static constexpr std::string_view kName = "LOCAL_POSITION_NED";
  std::uint32_t time_boot_ms = 0;  ///< [ms]
  float x = 0;                     ///< [m]
  float y = 0;                     ///< [m]
  float z = 0;                     ///< [m]
  float vx = 0;                    ///< [m/s]
  float vy = 0;                    ///< [m/s]
  float vz = 0;                    ///< [m/s]
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("time_boot_ms", m.time_boot_ms);
    field("x", m.x);
    field("y", m.y);
    field("z", m.z);
    field("vx", m.vx);
    field("vy", m.vy);
    field("vz", m.vz);
  }
};

struct GlobalPositionInt {
  static constexpr std::uint32_t kId = 33;
  static constexpr std::string_view kName = "GLOBAL_POSITION_INT";
  std::uint32_t time_boot_ms = 0;  ///< [ms]
  std::int32_t lat = 0;            ///< [degE7]
  std::int32_t lon = 0;            ///< [degE7]
  std::int32_t alt = 0;            ///< [mm]
  std::int32_t relative_alt = 0;   ///< [mm]
  std::int16_t vx = 0;             ///< [cm/s]
  std::int16_t vy = 0;             ///< [cm/s]
  std::int16_t vz = 0;             ///< [cm/s]
  std::uint16_t hdg = 0;           ///< [cdeg]
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("time_boot_ms", m.time_boot_ms);
    field("lat", m.lat);
    field("lon", m.lon);
    field("alt", m.alt);
    field("relative_alt", m.relative_alt);
    field("vx", m.vx);
    field("vy", m.vy);
    field("vz", m.vz);
    field("hdg", m.hdg);
  }
};

struct SetGpsGlobalOrigin {
  static constexpr std::uint32_t kId = 48;
  static constexpr std::string_view kName = "SET_GPS_GLOBAL_ORIGIN";
  std::int32_t latitude = 0;   ///< [degE7]
  std::int32_t longitude = 0;  ///< [degE7]
  std::int32_t altitude = 0;   ///< [mm]
  std::uint8_t target_system = 0;
  std::uint64_t time_usec = 0;  ///< [us]
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("latitude", m.latitude);
    field("longitude", m.longitude);
    field("altitude", m.altitude);
    field("target_system", m.target_system);
    field.Extensions();
    field("time_usec", m.time_usec);
  }
};

struct GpsGlobalOrigin {
  static constexpr std::uint32_t kId = 49;
  static constexpr std::string_view kName = "GPS_GLOBAL_ORIGIN";
  std::int32_t latitude = 0;    ///< [degE7]
  std::int32_t longitude = 0;   ///< [degE7]
  std::int32_t altitude = 0;    ///< [mm]
  std::uint64_t time_usec = 0;  ///< [us]
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("latitude", m.latitude);
    field("longitude", m.longitude);
    field("altitude", m.altitude);
    field.Extensions();
    field("time_usec", m.time_usec);
  }
};

struct RcChannels {
  static constexpr std::uint32_t kId = 65;
  static constexpr std::string_view kName = "RC_CHANNELS";
  std::uint32_t time_boot_ms = 0;  ///< [ms]
  std::uint16_t chan1_raw = 0;     ///< [us]
  std::uint16_t chan2_raw = 0;     ///< [us]
  std::uint16_t chan3_raw = 0;     ///< [us]
  std::uint16_t chan4_raw = 0;     ///< [us]
  std::uint16_t chan5_raw = 0;     ///< [us]
  std::uint16_t chan6_raw = 0;     ///< [us]
  std::uint16_t chan7_raw = 0;     ///< [us]
  std::uint16_t chan8_raw = 0;     ///< [us]
  std::uint16_t chan9_raw = 0;     ///< [us]
  std::uint16_t chan10_raw = 0;    ///< [us]
  std::uint16_t chan11_raw = 0;    ///< [us]
  std::uint16_t chan12_raw = 0;    ///< [us]
  std::uint16_t chan13_raw = 0;    ///< [us]
  std::uint16_t chan14_raw = 0;    ///< [us]
  std::uint16_t chan15_raw = 0;    ///< [us]
  std::uint16_t chan16_raw = 0;    ///< [us]
  std::uint16_t chan17_raw = 0;    ///< [us]
  std::uint16_t chan18_raw = 0;    ///< [us]
  std::uint8_t chancount = 0;
  std::uint8_t rssi = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("time_boot_ms", m.time_boot_ms);
    field("chan1_raw", m.chan1_raw);
    field("chan2_raw", m.chan2_raw);
    field("chan3_raw", m.chan3_raw);
    field("chan4_raw", m.chan4_raw);
    field("chan5_raw", m.chan5_raw);
    field("chan6_raw", m.chan6_raw);
    field("chan7_raw", m.chan7_raw);
    field("chan8_raw", m.chan8_raw);
    field("chan9_raw", m.chan9_raw);
    field("chan10_raw", m.chan10_raw);
    field("chan11_raw", m.chan11_raw);
    field("chan12_raw", m.chan12_raw);
    field("chan13_raw", m.chan13_raw);
    field("chan14_raw", m.chan14_raw);
    field("chan15_raw", m.chan15_raw);
    field("chan16_raw", m.chan16_raw);
    field("chan17_raw", m.chan17_raw);
    field("chan18_raw", m.chan18_raw);
    field("chancount", m.chancount);
    field("rssi", m.rssi);
  }
};

struct RequestDataStream {
  static constexpr std::uint32_t kId = 66;
  static constexpr std::string_view kName = "REQUEST_DATA_STREAM";
  std::uint16_t req_message_rate = 0;  ///< [Hz]
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  std::uint8_t req_stream_id = 0;
  std::uint8_t start_stop = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("req_message_rate", m.req_message_rate);
    field("target_system", m.target_system);
    field("target_component", m.target_component);
    field("req_stream_id", m.req_stream_id);
    field("start_stop", m.start_stop);
  }
};

struct CommandInt {
  static constexpr std::uint32_t kId = 75;
  static constexpr std::string_view kName = "COMMAND_INT";
  float param1 = 0;
  float param2 = 0;
  float param3 = 0;
  float param4 = 0;
  std::int32_t x = 0;
  std::int32_t y = 0;
  float z = 0;
  std::uint16_t command = 0;
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  std::uint8_t frame = 0;
  std::uint8_t current = 0;
  std::uint8_t autocontinue = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("param1", m.param1);
    field("param2", m.param2);
    field("param3", m.param3);
    field("param4", m.param4);
    field("x", m.x);
    field("y", m.y);
    field("z", m.z);
    field("command", m.command);
    field("target_system", m.target_system);
    field("target_component", m.target_component);
    field("frame", m.frame);
    field("current", m.current);
    field("autocontinue", m.autocontinue);
  }
};

struct CommandLong {
  static constexpr std::uint32_t kId = 76;
  static constexpr std::string_view kName = "COMMAND_LONG";
  float param1 = 0;
  float param2 = 0;
  float param3 = 0;
  float param4 = 0;
  float param5 = 0;
  float param6 = 0;
  float param7 = 0;
  std::uint16_t command = 0;
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  std::uint8_t confirmation = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("param1", m.param1);
    field("param2", m.param2);
    field("param3", m.param3);
    field("param4", m.param4);
    field("param5", m.param5);
    field("param6", m.param6);
    field("param7", m.param7);
    field("command", m.command);
    field("target_system", m.target_system);
    field("target_component", m.target_component);
    field("confirmation", m.confirmation);
  }
};

struct CommandAck {
  static constexpr std::uint32_t kId = 77;
  static constexpr std::string_view kName = "COMMAND_ACK";
  std::uint16_t command = 0;
  std::uint8_t result = 0;
  std::uint8_t progress = 0;  ///< [%]
  std::int32_t result_param2 = 0;
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("command", m.command);
    field("result", m.result);
    field.Extensions();
    field("progress", m.progress);
    field("result_param2", m.result_param2);
    field("target_system", m.target_system);
    field("target_component", m.target_component);
  }
};

struct SetPositionTargetLocalNed {
  static constexpr std::uint32_t kId = 84;
  static constexpr std::string_view kName = "SET_POSITION_TARGET_LOCAL_NED";
  std::uint32_t time_boot_ms = 0;  ///< [ms]
  float x = 0;                     ///< [m]
  float y = 0;                     ///< [m]
  float z = 0;                     ///< [m]
  float vx = 0;                    ///< [m/s]
  float vy = 0;                    ///< [m/s]
  float vz = 0;                    ///< [m/s]
  float afx = 0;                   ///< [m/s/s]
  float afy = 0;                   ///< [m/s/s]
  float afz = 0;                   ///< [m/s/s]
  float yaw = 0;                   ///< [rad]
  float yaw_rate = 0;              ///< [rad/s]
  std::uint16_t type_mask = 0;
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  std::uint8_t coordinate_frame = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("time_boot_ms", m.time_boot_ms);
    field("x", m.x);
    field("y", m.y);
    field("z", m.z);
    field("vx", m.vx);
    field("vy", m.vy);
    field("vz", m.vz);
    field("afx", m.afx);
    field("afy", m.afy);
    field("afz", m.afz);
    field("yaw", m.yaw);
    field("yaw_rate", m.yaw_rate);
    field("type_mask", m.type_mask);
    field("target_system", m.target_system);
    field("target_component", m.target_component);
    field("coordinate_frame", m.coordinate_frame);
  }
};

struct PositionTargetLocalNed {
  static constexpr std::uint32_t kId = 85;
  static constexpr std::string_view kName = "POSITION_TARGET_LOCAL_NED";
  std::uint32_t time_boot_ms = 0;  ///< [ms]
  float x = 0;                     ///< [m]
  float y = 0;                     ///< [m]
  float z = 0;                     ///< [m]
  float vx = 0;                    ///< [m/s]
  float vy = 0;                    ///< [m/s]
  float vz = 0;                    ///< [m/s]
  float afx = 0;                   ///< [m/s/s]
  float afy = 0;                   ///< [m/s/s]
  float afz = 0;                   ///< [m/s/s]
  float yaw = 0;                   ///< [rad]
  float yaw_rate = 0;              ///< [rad/s]
  std::uint16_t type_mask = 0;
  std::uint8_t coordinate_frame = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("time_boot_ms", m.time_boot_ms);
    field("x", m.x);
    field("y", m.y);
    field("z", m.z);
    field("vx", m.vx);
    field("vy", m.vy);
    field("vz", m.vz);
    field("afx", m.afx);
    field("afy", m.afy);
    field("afz", m.afz);
    field("yaw", m.yaw);
    field("yaw_rate", m.yaw_rate);
    field("type_mask", m.type_mask);
    field("coordinate_frame", m.coordinate_frame);
  }
};

struct Timesync {
  static constexpr std::uint32_t kId = 111;
  static constexpr std::string_view kName = "TIMESYNC";
  std::int64_t tc1 = 0;  ///< [ns]
  std::int64_t ts1 = 0;  ///< [ns]
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("tc1", m.tc1);
    field("ts1", m.ts1);
    field.Extensions();
    field("target_system", m.target_system);
    field("target_component", m.target_component);
  }
};

struct BatteryStatus {
  static constexpr std::uint32_t kId = 147;
  static constexpr std::string_view kName = "BATTERY_STATUS";
  std::int32_t current_consumed = 0;         ///< [mAh]
  std::int32_t energy_consumed = 0;          ///< [hJ]
  std::int16_t temperature = 0;              ///< [cdegC]
  std::array<std::uint16_t, 10> voltages{};  ///< [mV]
  std::int16_t current_battery = 0;          ///< [cA]
  std::uint8_t id = 0;
  std::uint8_t battery_function = 0;
  std::uint8_t type = 0;
  std::int8_t battery_remaining = 0;  ///< [%]
  std::int32_t time_remaining = 0;    ///< [s]
  std::uint8_t charge_state = 0;
  std::array<std::uint16_t, 4> voltages_ext{};  ///< [mV]
  std::uint8_t mode = 0;
  std::uint32_t fault_bitmask = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("current_consumed", m.current_consumed);
    field("energy_consumed", m.energy_consumed);
    field("temperature", m.temperature);
    field("voltages", m.voltages);
    field("current_battery", m.current_battery);
    field("id", m.id);
    field("battery_function", m.battery_function);
    field("type", m.type);
    field("battery_remaining", m.battery_remaining);
    field.Extensions();
    field("time_remaining", m.time_remaining);
    field("charge_state", m.charge_state);
    field("voltages_ext", m.voltages_ext);
    field("mode", m.mode);
    field("fault_bitmask", m.fault_bitmask);
  }
};

struct AutopilotVersion {
  static constexpr std::uint32_t kId = 148;
  static constexpr std::string_view kName = "AUTOPILOT_VERSION";
  std::uint64_t capabilities = 0;
  std::uint64_t uid = 0;
  std::uint32_t flight_sw_version = 0;
  std::uint32_t middleware_sw_version = 0;
  std::uint32_t os_sw_version = 0;
  std::uint32_t board_version = 0;
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  std::array<std::uint8_t, 8> flight_custom_version{};
  std::array<std::uint8_t, 8> middleware_custom_version{};
  std::array<std::uint8_t, 8> os_custom_version{};
  std::array<std::uint8_t, 18> uid2{};
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("capabilities", m.capabilities);
    field("uid", m.uid);
    field("flight_sw_version", m.flight_sw_version);
    field("middleware_sw_version", m.middleware_sw_version);
    field("os_sw_version", m.os_sw_version);
    field("board_version", m.board_version);
    field("vendor_id", m.vendor_id);
    field("product_id", m.product_id);
    field("flight_custom_version", m.flight_custom_version);
    field("middleware_custom_version", m.middleware_custom_version);
    field("os_custom_version", m.os_custom_version);
    field.Extensions();
    field("uid2", m.uid2);
  }
};

struct EkfStatusReport {
  static constexpr std::uint32_t kId = 193;
  static constexpr std::string_view kName = "EKF_STATUS_REPORT";
  float velocity_variance = 0;
  float pos_horiz_variance = 0;
  float pos_vert_variance = 0;
  float compass_variance = 0;
  float terrain_alt_variance = 0;
  std::uint16_t flags = 0;
  float airspeed_variance = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("velocity_variance", m.velocity_variance);
    field("pos_horiz_variance", m.pos_horiz_variance);
    field("pos_vert_variance", m.pos_vert_variance);
    field("compass_variance", m.compass_variance);
    field("terrain_alt_variance", m.terrain_alt_variance);
    field("flags", m.flags);
    field.Extensions();
    field("airspeed_variance", m.airspeed_variance);
  }
};

struct EstimatorStatus {
  static constexpr std::uint32_t kId = 230;
  static constexpr std::string_view kName = "ESTIMATOR_STATUS";
  std::uint64_t time_usec = 0;  ///< [us]
  float vel_ratio = 0;
  float pos_horiz_ratio = 0;
  float pos_vert_ratio = 0;
  float mag_ratio = 0;
  float hagl_ratio = 0;
  float tas_ratio = 0;
  float pos_horiz_accuracy = 0;  ///< [m]
  float pos_vert_accuracy = 0;   ///< [m]
  std::uint16_t flags = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("time_usec", m.time_usec);
    field("vel_ratio", m.vel_ratio);
    field("pos_horiz_ratio", m.pos_horiz_ratio);
    field("pos_vert_ratio", m.pos_vert_ratio);
    field("mag_ratio", m.mag_ratio);
    field("hagl_ratio", m.hagl_ratio);
    field("tas_ratio", m.tas_ratio);
    field("pos_horiz_accuracy", m.pos_horiz_accuracy);
    field("pos_vert_accuracy", m.pos_vert_accuracy);
    field("flags", m.flags);
  }
};

struct HomePosition {
  static constexpr std::uint32_t kId = 242;
  static constexpr std::string_view kName = "HOME_POSITION";
  std::int32_t latitude = 0;   ///< [degE7]
  std::int32_t longitude = 0;  ///< [degE7]
  std::int32_t altitude = 0;   ///< [mm]
  float x = 0;                 ///< [m]
  float y = 0;                 ///< [m]
  float z = 0;                 ///< [m]
  std::array<float, 4> q{};
  float approach_x = 0;         ///< [m]
  float approach_y = 0;         ///< [m]
  float approach_z = 0;         ///< [m]
  std::uint64_t time_usec = 0;  ///< [us]
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("latitude", m.latitude);
    field("longitude", m.longitude);
    field("altitude", m.altitude);
    field("x", m.x);
    field("y", m.y);
    field("z", m.z);
    field("q", m.q);
    field("approach_x", m.approach_x);
    field("approach_y", m.approach_y);
    field("approach_z", m.approach_z);
    field.Extensions();
    field("time_usec", m.time_usec);
  }
};

struct ExtendedSysState {
  static constexpr std::uint32_t kId = 245;
  static constexpr std::string_view kName = "EXTENDED_SYS_STATE";
  std::uint8_t vtol_state = 0;
  std::uint8_t landed_state = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("vtol_state", m.vtol_state);
    field("landed_state", m.landed_state);
  }
};

struct Statustext {
  static constexpr std::uint32_t kId = 253;
  static constexpr std::string_view kName = "STATUSTEXT";
  std::uint8_t severity = 0;
  std::array<char, 50> text{};
  std::uint16_t id = 0;
  std::uint8_t chunk_seq = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("severity", m.severity);
    field("text", m.text);
    field.Extensions();
    field("id", m.id);
    field("chunk_seq", m.chunk_seq);
  }
};

struct MountOrientation {
  static constexpr std::uint32_t kId = 265;
  static constexpr std::string_view kName = "MOUNT_ORIENTATION";
  std::uint32_t time_boot_ms = 0;  ///< [ms]
  float roll = 0;                  ///< [deg]
  float pitch = 0;                 ///< [deg]
  float yaw = 0;                   ///< [deg]
  float yaw_absolute = 0;          ///< [deg]
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("time_boot_ms", m.time_boot_ms);
    field("roll", m.roll);
    field("pitch", m.pitch);
    field("yaw", m.yaw);
    field.Extensions();
    field("yaw_absolute", m.yaw_absolute);
  }
};

struct GimbalDeviceAttitudeStatus {
  static constexpr std::uint32_t kId = 285;
  static constexpr std::string_view kName = "GIMBAL_DEVICE_ATTITUDE_STATUS";
  std::uint32_t time_boot_ms = 0;  ///< [ms]
  std::array<float, 4> q{};
  float angular_velocity_x = 0;  ///< [rad/s]
  float angular_velocity_y = 0;  ///< [rad/s]
  float angular_velocity_z = 0;  ///< [rad/s]
  std::uint32_t failure_flags = 0;
  std::uint16_t flags = 0;
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  float delta_yaw = 0;           ///< [rad]
  float delta_yaw_velocity = 0;  ///< [rad/s]
  std::uint8_t gimbal_device_id = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("time_boot_ms", m.time_boot_ms);
    field("q", m.q);
    field("angular_velocity_x", m.angular_velocity_x);
    field("angular_velocity_y", m.angular_velocity_y);
    field("angular_velocity_z", m.angular_velocity_z);
    field("failure_flags", m.failure_flags);
    field("flags", m.flags);
    field("target_system", m.target_system);
    field("target_component", m.target_component);
    field.Extensions();
    field("delta_yaw", m.delta_yaw);
    field("delta_yaw_velocity", m.delta_yaw_velocity);
    field("gimbal_device_id", m.gimbal_device_id);
  }
};

struct GimbalManagerSetPitchyaw {
  static constexpr std::uint32_t kId = 287;
  static constexpr std::string_view kName = "GIMBAL_MANAGER_SET_PITCHYAW";
  std::uint32_t flags = 0;
  float pitch = 0;       ///< [rad]
  float yaw = 0;         ///< [rad]
  float pitch_rate = 0;  ///< [rad/s]
  float yaw_rate = 0;    ///< [rad/s]
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  std::uint8_t gimbal_device_id = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("flags", m.flags);
    field("pitch", m.pitch);
    field("yaw", m.yaw);
    field("pitch_rate", m.pitch_rate);
    field("yaw_rate", m.yaw_rate);
    field("target_system", m.target_system);
    field("target_component", m.target_component);
    field("gimbal_device_id", m.gimbal_device_id);
  }
};

struct ObstacleDistance {
  static constexpr std::uint32_t kId = 330;
  static constexpr std::string_view kName = "OBSTACLE_DISTANCE";
  std::uint64_t time_usec = 0;                ///< [us]
  std::array<std::uint16_t, 72> distances{};  ///< [cm]
  std::uint16_t min_distance = 0;             ///< [cm]
  std::uint16_t max_distance = 0;             ///< [cm]
  std::uint8_t sensor_type = 0;
  std::uint8_t increment = 0;  ///< [deg]
  float increment_f = 0;       ///< [deg]
  float angle_offset = 0;      ///< [deg]
  std::uint8_t frame = 0;
  template <class Self, class Visitor>
  static constexpr void Visit(Self& m, Visitor&& field) {
    field("time_usec", m.time_usec);
    field("distances", m.distances);
    field("min_distance", m.min_distance);
    field("max_distance", m.max_distance);
    field("sensor_type", m.sensor_type);
    field("increment", m.increment);
    field.Extensions();
    field("increment_f", m.increment_f);
    field("angle_offset", m.angle_offset);
    field("frame", m.frame);
  }
};

/// Every message that the codec knows.
using AllMessages =
    std::tuple<Heartbeat, SysStatus, SystemTime, ParamRequestRead, ParamValue, ParamSet, GpsRawInt, Attitude,
               AttitudeQuaternion, LocalPositionNed, GlobalPositionInt, SetGpsGlobalOrigin, GpsGlobalOrigin,
               RcChannels, RequestDataStream, CommandInt, CommandLong, CommandAck, SetPositionTargetLocalNed,
               PositionTargetLocalNed, Timesync, BatteryStatus, AutopilotVersion, EkfStatusReport,
               EstimatorStatus, HomePosition, ExtendedSysState, Statustext, MountOrientation,
               GimbalDeviceAttitudeStatus, GimbalManagerSetPitchyaw, ObstacleDistance>;

}  // namespace soffit::mavlink
