#include <brdfs/fit/solver_log.h>

#include <glog/logging.h>

#include <mutex>
#include <set>
#include <utility>

namespace hshfit::brdfs {
namespace {

class Sink : public google::LogSink {
public:
    explicit Sink(std::function<void(const std::string&)> take) : take_(std::move(take)) {}

    void send(google::LogSeverity severity, const char*, const char*, int,
              const google::LogMessageTime&, const char* message, std::size_t length) override {
        if (severity < google::GLOG_WARNING) return;
        std::string text(message, length);
        const std::lock_guard lock(mutex_);
        if (said_.insert(text).second) take_("Ceres: " + text);
    }

private:
    std::function<void(const std::string&)> take_;
    std::mutex mutex_;
    std::set<std::string> said_;
};

}  // namespace

void takeSolverLog(std::function<void(const std::string&)> take) {
    if (google::IsGoogleLoggingInitialized()) return;
    // A message before this call would go to standard error whatever the flags say.
    google::InitGoogleLogging("hshfit");
    FLAGS_logtostderr = false;
    FLAGS_stderrthreshold = google::GLOG_FATAL;
    for (const auto severity :
         {google::GLOG_INFO, google::GLOG_WARNING, google::GLOG_ERROR, google::GLOG_FATAL}) {
        google::SetLogDestination(severity, "");  // no file
    }
    static Sink* sink = nullptr;  // as long as the process: threads may still log at its end
    sink = new Sink(std::move(take));
    google::AddLogSink(sink);
}

}  // namespace hshfit::brdfs
