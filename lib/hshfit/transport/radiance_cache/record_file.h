#pragma once

#include <hshfit/files/atomic_file.h>
#include <hshfit/transport/radiance_cache/record.h>

#include <string>
#include <vector>

namespace hshfit::inline transport::inline radiance_cache {

/// The light of a scene as a file keeps it.
struct StoredRecords {
    /// The scene and the settings that decide what records hold. Records of another key are of no
    /// use.
    std::string key;
    std::vector<int> orders = {};  ///< of each kind; 0 for irradiance
    std::vector<std::size_t> functions = {};
    std::vector<Record> records = {};
    std::vector<IrradiancePoint> points = {};
    double spacing = 0;  ///< of the points
};

/// A tensor file (tensor_file.h): `header` as JSON, and of each record position, frame, kind,
/// radius with distance, norm and noise (float64), and values (float32); of each point nine
/// float32 and its side (uint32). Throws OutputError.
void writeRecords(const StoredRecords& stored, AtomicFile& file);

/// Throws InputError that starts with `path` for a file that is no such file, is cut off, has
/// numbers that are not finite or of the wrong count, or has another key.
StoredRecords readRecords(const std::string& path, const std::string& key);

}  // namespace hshfit::inline transport::inline radiance_cache
