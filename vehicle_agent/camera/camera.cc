#include "vehicle_agent/camera/camera.h"

#include <gst/app/gstappsink.h>
#include <gst/gst.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <optional>

#include "vehicle_agent/camera/jpeg.h"

namespace soffit {
namespace {

using std::chrono::steady_clock;

constexpr std::size_t kMaxPictureBytes = 64u << 20;
constexpr std::chrono::milliseconds kLook(50);  // Between two looks at what the pipeline tells.
constexpr std::int64_t kClockTolerance_ns = 50'000'000;
constexpr const char* kSinkName = "soffit_picture";

std::int64_t NowUtc_ns() {
  using namespace std::chrono;
  return duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count();
}

Error Unavailable(std::string message) { return {Error::Code::kUnavailable, std::move(message)}; }

struct Unref {
  void operator()(GstElement* element) const { gst_object_unref(element); }
  void operator()(GstBus* bus) const { gst_object_unref(bus); }
  void operator()(GstSample* sample) const { gst_sample_unref(sample); }
  void operator()(GstMessage* message) const { gst_message_unref(message); }
  void operator()(GError* error) const { g_error_free(error); }
};
template <class T>
using Owned = std::unique_ptr<T, Unref>;

/// A running pipeline that ends in our sink.
class Pipeline {
 public:
  static Result<std::unique_ptr<Pipeline>> Make(const std::string& description, bool is_stream) {
    // While GStreamer loads a plugin for one thread, others do not find that plugin's elements.
    static std::mutex making;
    const std::lock_guard lock(making);
    gst_init(nullptr, nullptr);
    const std::string whole = description + " ! appsink name=" + kSinkName + " sync=false" +
                              (is_stream ? " max-buffers=1 drop=true" : "");
    GError* raw_error = nullptr;
    Owned<GstElement> pipeline(gst_parse_launch(whole.c_str(), &raw_error));
    const Owned<GError> error(raw_error);
    if (error || !pipeline) {
      return InvalidInput("pipeline '" + description + "': " + (error ? error->message : "cannot be made"));
    }
    Owned<GstElement> sink(
        GST_IS_BIN(pipeline.get()) ? gst_bin_get_by_name(GST_BIN(pipeline.get()), kSinkName) : nullptr);
    if (!sink) return InvalidInput("pipeline '" + description + "': cannot be ended with a sink");
    return std::unique_ptr<Pipeline>(new Pipeline(std::move(pipeline), std::move(sink)));
  }

  ~Pipeline() { Stop(); }

  void Start() { gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING); }
  void Stop() { gst_element_set_state(pipeline_.get(), GST_STATE_NULL); }

  /// Appends the next buffer to `bytes`; false when none comes within `wait`, or the stream is at its end.
  bool Pull(std::vector<std::uint8_t>& bytes, std::chrono::nanoseconds wait) {
    const Owned<GstSample> sample(
        gst_app_sink_try_pull_sample(GST_APP_SINK(sink_.get()), static_cast<GstClockTime>(wait.count())));
    GstBuffer* buffer = sample ? gst_sample_get_buffer(sample.get()) : nullptr;
    GstMapInfo map;
    if (buffer == nullptr || gst_buffer_map(buffer, &map, GST_MAP_READ) == FALSE) return false;
    bytes.insert(bytes.end(), map.data, map.data + map.size);
    gst_buffer_unmap(buffer, &map);
    return true;
  }

  bool IsAtEnd() const { return gst_app_sink_is_eos(GST_APP_SINK(sink_.get())) == TRUE; }

  /// The first error that the pipeline told since it was asked last; empty when there is none.
  std::string FindError() {
    const Owned<GstBus> bus(gst_element_get_bus(pipeline_.get()));
    const Owned<GstMessage> message(gst_bus_pop_filtered(bus.get(), GST_MESSAGE_ERROR));
    if (!message) return {};
    GError* raw_error = nullptr;
    gst_message_parse_error(message.get(), &raw_error, nullptr);
    const Owned<GError> error(raw_error);
    return error ? error->message : "unknown error";
  }

 private:
  Pipeline(Owned<GstElement> pipeline, Owned<GstElement> sink)
      : pipeline_(std::move(pipeline)), sink_(std::move(sink)) {}

  Owned<GstElement> pipeline_;
  Owned<GstElement> sink_;
};

steady_clock::time_point After(double seconds) {
  return steady_clock::now() +
         std::chrono::duration_cast<steady_clock::duration>(std::chrono::duration<double>(seconds));
}

/// What kept a picture from coming, for people. `error` is what the pipeline told; empty: nothing.
Error DescribeFailure(const std::string& error, const CameraOptions& options) {
  const std::string what =
      error.empty() ? "no picture within " + std::to_string(options.timeout_s) + " s" : error;
  return Unavailable(what + " (" + options.pipeline + ")");
}

/// The pipeline runs to its end for each picture: an HTTP snapshot, a file, a still camera.
class SnapshotCamera : public CameraDevice {
 public:
  SnapshotCamera(std::unique_ptr<Pipeline> pipeline, const CameraOptions& options)
      : pipeline_(std::move(pipeline)), options_(options) {}

  Result<Picture> Take() override {
    const auto deadline = After(options_.timeout_s);
    std::vector<std::uint8_t> bytes;
    std::string error;
    pipeline_->Start();
    while (!pipeline_->IsAtEnd() && error.empty() && bytes.size() < kMaxPictureBytes &&
           steady_clock::now() < deadline) {
      if (!pipeline_->Pull(bytes, kLook)) error = pipeline_->FindError();
    }
    const std::int64_t arrival_utc_ns = NowUtc_ns();
    const bool is_whole = pipeline_->IsAtEnd() && !bytes.empty();
    if (!is_whole && error.empty()) error = pipeline_->FindError();
    pipeline_->Stop();
    if (!is_whole) return DescribeFailure(error, options_);
    return MakePicture(std::move(bytes), arrival_utc_ns, options_);
  }

 private:
  std::unique_ptr<Pipeline> pipeline_;
  CameraOptions options_;
};

/// The pipeline runs all the time, and the first buffer after the call is the picture.
class StreamCamera : public CameraDevice {
 public:
  StreamCamera(std::unique_ptr<Pipeline> pipeline, const CameraOptions& options)
      : pipeline_(std::move(pipeline)), options_(options) {
    pipeline_->Start();
  }

  Result<Picture> Take() override {
    const auto deadline = After(options_.timeout_s);
    const std::int64_t called_utc_ns = NowUtc_ns();
    std::string error;
    while (error.empty() && steady_clock::now() < deadline) {
      std::vector<std::uint8_t> bytes;
      if (!pipeline_->Pull(bytes, kLook)) {
        error = pipeline_->FindError();
        if (error.empty() && pipeline_->IsAtEnd()) error = "the stream has ended";
        continue;
      }
      Result<Picture> picture = MakePicture(std::move(bytes), NowUtc_ns(), options_);
      if (!picture.ok() || picture.value().exposure_utc_ns >= called_utc_ns) return picture;
    }
    pipeline_->Stop();  // A lost device comes back only to a pipeline that is started anew.
    pipeline_->Start();
    return DescribeFailure(error, options_);
  }

 private:
  std::unique_ptr<Pipeline> pipeline_;
  CameraOptions options_;
};

class FolderCamera : public CameraDevice {
 public:
  FolderCamera(std::vector<std::filesystem::path> files, const CameraOptions& options)
      : files_(std::move(files)), options_(options) {}

  Result<Picture> Take() override {
    if (next_ >= files_.size()) return Unavailable("folder '" + options_.folder + "': no picture is left");
    const std::filesystem::path& file = files_[next_++];
    std::ifstream stream(file, std::ios::binary);
    std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(stream), {}};
    Result<Picture> picture = MakePicture(std::move(bytes), NowUtc_ns(), options_);
    if (!picture.ok()) return Unavailable(file.string() + ": " + picture.error().message);
    return picture;
  }

 private:
  std::vector<std::filesystem::path> files_;
  CameraOptions options_;
  std::size_t next_ = 0;
};

Result<std::unique_ptr<CameraDevice>> OpenFolder(const CameraOptions& options) {
  std::vector<std::filesystem::path> files;
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator(options.folder, problem)) {
    const std::string ending = entry.path().extension().string();
    if (ending == ".jpg" || ending == ".jpeg" || ending == ".JPG") files.push_back(entry.path());
  }
  if (problem) return Unavailable("folder '" + options.folder + "': " + problem.message());
  if (files.empty()) return Unavailable("folder '" + options.folder + "': there is no JPEG picture in it");
  std::sort(files.begin(), files.end());
  return std::unique_ptr<CameraDevice>(std::make_unique<FolderCamera>(std::move(files), options));
}

}  // namespace

bool IsPresent(const CameraOptions& options) { return !options.pipeline.empty() || !options.folder.empty(); }

Result<Intrinsics> MakeIntrinsics(const CameraOptions& options) {
  Intrinsics intrinsics{
      options.width_px, options.height_px, options.fx_px, options.fy_px, options.cx_px, options.cy_px, {}};
  if (options.distortion.size() != intrinsics.distortion.size()) {
    return InvalidInput("distortion has " + std::to_string(options.distortion.size()) +
                        " numbers, must have 5: k1, k2, p1, p2, k3");
  }
  std::copy(options.distortion.begin(), options.distortion.end(), intrinsics.distortion.begin());
  return intrinsics;
}

Result<Picture> MakePicture(std::vector<std::uint8_t> bytes, std::int64_t arrival_utc_ns,
                            const CameraOptions& options) {
  const Result<JpegInfo> info = CheckJpeg(bytes);
  if (!info.ok()) return info.error();
  const auto& [width_px, height_px] = info.value();
  if (width_px != options.width_px || height_px != options.height_px) {
    return InvalidInput("the picture has " + std::to_string(width_px) + " x " + std::to_string(height_px) +
                        " pixels, the configuration says " + std::to_string(options.width_px) + " x " +
                        std::to_string(options.height_px));
  }
  if (const std::string problem = FindExposureProblem(bytes); !problem.empty()) return InvalidInput(problem);
  const auto latency_ns = static_cast<std::int64_t>(options.latency_s * 1e9);
  const auto oldest_ns = arrival_utc_ns - latency_ns - static_cast<std::int64_t>(options.timeout_s * 1e9);
  const std::optional<std::int64_t> told_ns = FindExposureTime(bytes);
  const bool is_ours = !told_ns || (*told_ns >= oldest_ns && *told_ns <= arrival_utc_ns + kClockTolerance_ns);
  Picture picture;
  picture.exposure_utc_ns = told_ns.value_or(arrival_utc_ns - latency_ns);
  picture.shutter_s = FindShutterTime(bytes).value_or(options.shutter_s);
  picture.has_trusted_time = is_ours;
  picture.bytes = std::move(bytes);
  return picture;
}

Result<std::unique_ptr<CameraDevice>> OpenCamera(const CameraOptions& options) {
  if (!options.folder.empty()) return OpenFolder(options);
  Result<std::unique_ptr<Pipeline>> pipeline = Pipeline::Make(options.pipeline, options.is_stream);
  if (!pipeline.ok()) return pipeline.error();
  if (options.is_stream) {
    return std::unique_ptr<CameraDevice>(
        std::make_unique<StreamCamera>(std::move(pipeline).value(), options));
  }
  return std::unique_ptr<CameraDevice>(
      std::make_unique<SnapshotCamera>(std::move(pipeline).value(), options));
}

}  // namespace soffit
