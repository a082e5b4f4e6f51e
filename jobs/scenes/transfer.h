#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/option_row.h>
#include <jobs/source/quality.h>

#include <hshfit/precomputed_transfer/interreflection.h>
#include <hshfit/precomputed_transfer/matrix_clusters.h>
#include <hshfit/precomputed_transfer/transfer_mesh.h>

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// Light that reaches a vertex: with nothing in the way, past what is in the way, and by other
/// surfaces too.
enum class TransferKind { unshadowed, shadowed, interreflected };

struct TransferOptions {
    TransferKind kind = TransferKind::interreflected;
    int passes = 5;      ///< of interreflection; the paper's number
    int order = 5;       ///< bands of light
    int localOrder = 0;  ///< bands of HSH above each vertex; 0: vectors alone
    std::size_t rays = 2025;
    std::uint64_t seed = 1;
    TransferMeshOptions mesh = {};
    double memory = 4096;  ///< the most that may be needed, MB
    /// Numbers of clusters to try for matrices; empty or 0: they are not compressed.
    std::vector<std::size_t> clusters = {16, 64, 256};
    std::size_t components = 16;  ///< the most of a cluster
    /// The smallest of the compressed forms with at most this error is written, or the best with at
    /// most so many bytes. At 10 % the borders of clusters are seen on a glossy ball, at 5 % they
    /// are not; noise of the default number of rays is 2 % (docs/explanation/transfer.md).
    double error = 0.05;
    std::optional<std::size_t> bytes = {};
    /// Lights of the pictures and of the page, as specifications; the lights of the scene come
    /// first.
    std::vector<std::string> lights = {};
    /// BRDFs that the page can put in the place of the scene's materials.
    std::vector<std::string> swaps = {};
    /// Paths through each pixel of the reference pictures; 0: no pictures.
    int referenceSamples = 0;
    std::string camera = {};  ///< of the pictures; empty: all
    /// For rays, passes and pictures: rays, passes and paths that do not fit are left out. None: no
    /// end.
    std::optional<double> seconds = {};
    /// Keep finished parts in FOLDER/.hshfit-transfer.partial until all is written, and go on from
    /// the parts of a run that was stopped.
    bool resume = false;
    bool force = false;  ///< replace existing files
};
OptionRows<TransferOptions> transferOptions();

/// The distance of a picture by transfer from one by path tracing.
struct TransferPictureError {
    int order = 0;          ///< bands of light
    double relativeL2 = 0;  ///< root of the sum of squares over the reference's
    double maximum = 0;     ///< the largest difference of a pixel and colour, over the mean
    int column = 0, row = 0;
};
struct TransferPicture {
    std::string camera, light;
    double captured = 0;  ///< the light's energy in `order` bands; NaN where it does not exist
    double noise = 0;     ///< relative standard error of the reference, like relativeL2
    std::vector<TransferPictureError> errors = {};  ///< by order, from 1
    std::vector<std::string> files = {};
};

struct Transferred {
    std::string scene;
    TransferOptions options;
    std::size_t vertices = 0, triangles = 0, degenerate = 0, twoSided = 0, buried = 0;
    double edge = 0;
    std::size_t memory = 0;  ///< needed at most, bytes
    std::size_t rays = 0, inside = 0;
    std::size_t resumed = 0;  ///< vertices from a run that was stopped
    double noise = 0, largestNoise = 0;
    std::size_t noisiest = 0;
    std::size_t channels = 1;
    std::vector<double> energy = {};  ///< by pass
    std::size_t vectorBytes = 0, matrixBytes = 0;
    std::vector<ClusterError> compression = {};   ///< all that were tried
    std::optional<ClusterError> compressed = {};  ///< the one that is written
    std::optional<Poor> poor = {};                ///< it misses the bound that was asked for
    std::vector<TransferMaterial> materials = {};
    std::vector<std::string> objects = {};
    std::vector<std::size_t> objectMaterials = {};
    std::vector<TransferPicture> pictures = {};
    std::vector<std::string> files = {};
    double seconds = 0;      ///< of the rays
    double embreeShare = 0;  ///< of their processor time
    double passSeconds = 0;  ///< of interreflection
};

/// Precomputed radiance transfer of a scene file in `folder`: transfer.tensor with the arrays,
/// transfer.json that says what they are, and pictures. Same bits on any number of threads. Throws
/// UsageError, also where more than `memory` would be needed, InputError, NumericError and
/// OutputError.
Transferred transfer(const std::string& scene, const std::string& folder,
                     const TransferOptions& options, const Listener& listener = {});

/// Rays that this run traced, a second.
double raysPerSecond(const Transferred& done);

/// transfer.json; with `times` the answer of the command, which adds what took how long.
nlohmann::ordered_json transferJson(const Transferred& done, bool times);

std::string kindName(TransferKind kind);

}  // namespace hshfit::jobs
