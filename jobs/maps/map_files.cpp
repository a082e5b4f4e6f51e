#include "map_files.h"

#include <filesystem>

namespace hshfit::jobs {

namespace fs = std::filesystem;

MapFiles::MapFiles(const std::string& folder, bool force, Processes& processes)
    : processes_(processes) {
    if (!processes.isFirst()) return;
    files_.emplace(folder, force);
    files_->removeOthers();
}

void MapFiles::requireFree(const std::vector<std::string>& names) const {
    if (!files_) return;
    for (const std::string& name : names) files_->requireFree(name);
}

std::string MapFiles::texture(const std::string& name) {
    std::string path;
    if (files_) path = fs::absolute(files_->add(name).temporaryPath()).string();
    processes_.broadcast(path);
    names_.push_back(name);
    return path;
}

void MapFiles::write(const std::string& name, std::string_view text) {
    if (files_) files_->write(name, text);
    names_.push_back(name);
}

std::string MapFiles::file(const std::string& name, const std::function<void(AtomicFile&)>& fill) {
    std::string path;
    if (files_) path = fs::absolute(files_->write(name, fill).temporaryPath()).string();
    processes_.broadcast(path);
    names_.push_back(name);
    return path;
}

void MapFiles::writePart(const std::string& name, std::string_view text) {
    if (files_) files_->writePart(name, text);
    names_.push_back(name);
}

std::vector<std::string> MapFiles::commit() {
    if (files_) files_->commit();
    processes_.meet();
    return names_;
}

}  // namespace hshfit::jobs
