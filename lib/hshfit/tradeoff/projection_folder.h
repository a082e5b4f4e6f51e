#pragma once

#include <hshfit/error.h>
#include <hshfit/representation/representation.h>

#include <functional>
#include <optional>
#include <string>

namespace hshfit::tradeoff {

/// A projection, or the reason why there is none.
struct KeptProjection {
    Representation representation = {};
    double seconds = 0;  ///< of its making, on all threads
    ExitCode failure = ExitCode::done;
    std::string reason = {};
};

/// A folder with projections of earlier runs, of any materials. Runs may use it at the same time.
struct ProjectionFolder {
    std::string path = {};  ///< empty: nothing is kept
    /// All that f depends on beside its name, as text: checksums of the files that specifications,
    /// one a line, name, and of values of the BRDF.
    std::function<std::string(const Brdf& brdf, const std::string& specifications)> contentOf = {};
    /// Takes a sentence about each file that is not as it was written.
    std::function<void(const std::string&)> tell = {};

    bool isUsed() const { return !path.empty(); }
    /// Makes the folder. Throws OutputError.
    void make() const;
    /// The projection of a key, which is any text that says what it depends on. None where there
    /// is none, or its file is damaged, which is told.
    std::optional<KeptProjection> find(const std::string& key) const;
    /// Throws OutputError.
    void keep(const std::string& key, const KeptProjection& projection) const;

private:
    std::string fileOf(const std::string& sum) const;
};

}  // namespace hshfit::tradeoff
