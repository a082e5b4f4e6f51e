#include <hshfit/transport/radiance_cache/cache.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/rotation/hemisphere_rotation.h>
#include <hshfit/transport/radiance_cache/internal/record_place.h>
#include <hshfit/wording.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

namespace hshfit::inline transport::inline radiance_cache {
namespace {

/// Radii by second derivatives are the geometric mean of the one of even relative errors and this
/// share of the picture's height, and at most so much longer along one axis: the least error for
/// the number of records among factors of 2 (docs/explanation/illuminate.md).
constexpr double evenness = 0.15, mostStretch = 4;

/// Bytes of a record beside its coefficients: itself and its shares of index and deque, rounded up.
constexpr std::size_t recordOverhead = sizeof(Record) + 128;

Direction between(const Point& from, const Point& to) {
    return {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
}
double lengthOf(const Direction& d) {
    return std::sqrt(dot(d, d));
}

double normOf(std::span<const float> values) {
    double squares = 0;
    for (const float value : values)
        squares += static_cast<double>(value) * static_cast<double>(value);
    return std::sqrt(squares);
}

double extentOf(const Mesh& mesh) {
    double extent = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        double least = std::numeric_limits<double>::infinity(), most = -least;
        for (const MeshVector& p : mesh.positions) {
            least = std::min(least, static_cast<double>(p[k]));
            most = std::max(most, static_cast<double>(p[k]));
        }
        extent = std::max(extent, most - least);
    }
    return extent;
}

void check(const CacheOptions& options, const SurfaceScene& scene) {
    if (!(options.accuracy > 0 && options.accuracy <= 1)) {
        throw UsageError(fmt::format("{} is {}; valid: above 0, up to 1",
                                     Setting{"CacheOptions::accuracy"}, options.accuracy));
    }
    if (options.fewestBounces > 2) {
        throw UsageError(fmt::format("{} is {}; records can leave out 2 bounces at most",
                                     Setting{"PathOptions::fewestBounces"}, options.fewestBounces));
    }
    if (options.direct == DirectLight::sampled) return;
    if (options.fewestBounces > 1) {
        throw UsageError(
            fmt::format("{} is {}; records that gather direct light cannot leave it "
                        "out",
                        Setting{"PathOptions::fewestBounces"}, options.fewestBounces));
    }
    RandomNumbers random(1, 0);
    for (int k = 0; k < 256 && scene.environment().any(); ++k) {
        const double u = random.next(), v = random.next();
        if (scene.environment().sample({u, v, random.next()}).delta)
            throw UsageError("rays of records cannot meet directional lights: sample direct light");
    }
}

std::vector<int> ordersOf(const std::vector<IncomingFunctions>& kinds) {
    std::vector<int> orders;
    for (const IncomingFunctions& kind : kinds)
        orders.push_back(kind.basis() ? kind.basis()->order() : 0);
    return orders;
}
std::vector<std::size_t> countsOf(const std::vector<IncomingFunctions>& kinds) {
    std::vector<std::size_t> counts;
    for (const IncomingFunctions& kind : kinds) counts.push_back(kind.size());
    return counts;
}

}  // namespace

/// Rotations of each kind, made when the first record meets a surface of another direction.
struct RadianceCache::Turning {
    explicit Turning(std::size_t kinds) : rotations(kinds), once(kinds) {}
    const HemisphereRotation& of(std::uint32_t kind, const Basis& basis) {
        std::call_once(once[kind], [&] {
            rotations[kind] = std::make_unique<HemisphereRotation>(
                basis,
                HemisphereRotationOptions{.method = basis.order() <= 32 ? HemisphereMethod::table
                                                                        : HemisphereMethod::exact});
        });
        return *rotations[kind];
    }
    std::vector<std::unique_ptr<HemisphereRotation>> rotations;
    std::vector<std::once_flag> once;
};

void CacheOptions::asPublished() {
    gradient = Gradient::hitPoints;
    gradientLimit = neighbourClamping = errorControl = false;
}

RadianceCache::RadianceCache(const SurfaceScene& scene, const CacheOptions& options,
                             StoredRecords* stored)
    : options_(options), walk_(scene, options.direct), extent_(extentOf(scene.mesh())) {
    check(options, scene);
    materials_ = chooseLight(scene, options.choice);
    for (const IncomingFunctions& functions : materials_.kinds) {
        strata_.emplace_back(functions, options.rays,
                             options.errorControl && options.gradient != Gradient::none);
        index_.emplace_back();
    }
    turning_ = std::make_unique<Turning>(materials_.kinds.size());
    if (!stored) {
        findSurfaces();
        return;
    }
    const bool fits = stored->orders == ordersOf(materials_.kinds) &&
                      stored->functions == countsOf(materials_.kinds);
    if (!fits) throw InputError("the records are of other orders than the scene's materials");
    for (const IrradiancePoint& point : stored->points) {
        if (point.side >= 2 * scene.objects().size())
            throw InputError("the records have points on objects that the scene does not have");
    }
    surfaces_ = std::make_unique<SurfaceIrradiance>(std::move(stored->points), stored->spacing,
                                                    bouncesOfSurfaces());
    for (Record& record : stored->records) store(std::move(record));
    settle();
}

RadianceCache::RadianceCache(const SurfaceScene& scene, const CacheOptions& options)
    : RadianceCache(scene, options, nullptr) {}
RadianceCache::RadianceCache(const SurfaceScene& scene, const CacheOptions& options,
                             StoredRecords stored)
    : RadianceCache(scene, options, &stored) {}

/// Light at a record's hits has one reflection there and one at the record; sampled light comes
/// with one more.
int RadianceCache::bouncesOfSurfaces() const {
    return options_.mostBounces - (options_.direct == DirectLight::sampled ? 3 : 2);
}

void RadianceCache::findSurfaces() {
    const int bounces = bouncesOfSurfaces();
    const SurfaceIrradianceOptions surfaces{.points = options_.surfacePoints,
                                            .rays = options_.surfaceRays,
                                            .bounces = bounces,
                                            .seed = options_.seed,
                                            .progress = options_.progress};
    surfaces_ = bounces < 0
                    ? std::make_unique<SurfaceIrradiance>(std::vector<IrradiancePoint>(), 0, 0)
                    : std::make_unique<SurfaceIrradiance>(walk_, surfaces);
    rays_ = surfaces_->rays();
}

StoredRecords RadianceCache::stored(const std::string& key) const {
    return {.key = key,
            .orders = ordersOf(materials_.kinds),
            .functions = countsOf(materials_.kinds),
            .records = {records_.begin(), records_.end()},
            .points = surfaces_->points(),
            .spacing = surfaces_->spacing()};
}

RadianceCache::~RadianceCache() = default;

bool RadianceCache::takesRecords(const SurfaceHit& hit) const {
    const std::size_t material = scene().objects()[hit.object].material;
    return materials_.materials[material].way != LightWay::sampled;
}

/// One over Ward's weight; infinite where the record cannot be used.
double RadianceCache::errorOf(const Record& record, const Point& at,
                              const Direction& normal) const {
    const double cosine = dot(normal, record.frame.normal);
    if (!(cosine > 0.1)) return std::numeric_limits<double>::infinity();
    const Direction gap = between(record.position, at);
    // A record before the surface may see what the surface cannot (Ward et al. 1988).
    if (dot(gap, normal + record.frame.normal) < -0.1 * options_.accuracy * record.radius)
        return std::numeric_limits<double>::infinity();
    double square = dot(gap, gap) / (record.radius * record.radius);
    if (record.longRadius > record.radius) {
        const double along = dot(gap, record.longAxis) / record.radius;
        const double ratio = record.radius / record.longRadius;
        square = std::max(0.0, square - (1 - ratio * ratio) * along * along);
    }
    return std::sqrt(square) + std::sqrt(std::max(0.0, 1 - cosine));
}

std::vector<RadianceCache::Near>& RadianceCache::near(const SurfaceHit& hit, std::uint32_t kind,
                                                      double reach) const {
    thread_local std::vector<std::uint32_t> found;
    thread_local std::vector<Near> usable;
    usable.clear();
    // The index has reaches as they are; a wider look-up asks with a box about the point.
    const double about = reach > 1 ? (reach - 1) * options_.accuracy * extent_ / 8 : 0;
    index_[kind].near(hit.position, about, found);
    const double a = options_.accuracy * reach;
    for (const std::uint32_t k : found) {
        const Record& record = records_[k];
        const double error = errorOf(record, hit.position, hit.frame.normal);
        if (!(error < a)) continue;
        usable.push_back({&record, 1 / std::max(error, 1e-9)});
    }
    return usable;
}

bool RadianceCache::covers(const SurfaceHit& hit) const {
    const std::size_t material = scene().objects()[hit.object].material;
    return !near(hit, materials_.materials[material].kind, 1).empty();
}

bool RadianceCache::radiance(const SurfaceHit& hit, Rgb& radiance, double reach) const {
    const std::size_t index = scene().objects()[hit.object].material;
    const MaterialLight& material = materials_.materials[index];
    const std::vector<Near>& usable = near(hit, material.kind, reach);
    if (usable.empty()) return false;
    Rgb sum{};
    double weights = 0;
    for (const Near& one : usable) weights += one.weight;
    if (material.way == LightWay::irradiance) {
        for (const Near& one : usable) {
            const Rgb light = irradianceAt(*one.record, hit);
            for (std::size_t c = 0; c < 3; ++c)
                sum[c] += one.weight * light[c] * material.diffuse[c];
        }
    } else {
        const IncomingFunctions& functions = materials_.kinds[material.kind];
        thread_local std::vector<float> lobe;
        lobe.resize(material.channels * functions.size());
        material.at(functions, hit.wo, lobe.data());
        for (const Near& one : usable) addDotProduct(one, hit, material, lobe, sum);
    }
    for (std::size_t c = 0; c < 3; ++c) radiance[c] = std::max(0.0, sum[c] / weights);
    return true;
}

Rgb RadianceCache::irradianceAt(const Record& record, const SurfaceHit& hit) const {
    const Direction gap = between(record.position, hit.position);
    const Direction turn = cross(record.frame.normal, hit.frame.normal);
    const std::array<double, 5> along{
        1, dot(gap, record.frame.tangent), dot(gap, record.frame.bitangent),
        dot(turn, record.frame.tangent), dot(turn, record.frame.bitangent)};
    Rgb light{};
    for (std::size_t part = 0; part < 5; ++part) {
        const std::span<const float> values = record.part(part, 1);
        for (std::size_t c = 0; c < 3; ++c)
            light[c] += along[part] * static_cast<double>(values[c]);
    }
    for (double& value : light) value = std::max(0.0, value);
    return light;
}

/// The coefficients of light in the record's frame times f cos(theta_i) turned into it:
/// Eq. 24 with the transposed rotation on the other factor, of which there are fewer vectors.
void RadianceCache::addDotProduct(const Near& near, const SurfaceHit& hit,
                                  const MaterialLight& material, const std::vector<float>& lobe,
                                  Rgb& sum) const {
    const Record& record = *near.record;
    const IncomingFunctions& functions = materials_.kinds[material.kind];
    const std::size_t size = functions.size();
    thread_local std::vector<float> turned;
    const std::vector<float>* weights = &lobe;
    const Frame &a = record.frame, &b = hit.frame;
    const double trace =
        dot(a.tangent, b.tangent) + dot(a.bitangent, b.bitangent) + dot(a.normal, b.normal);
    if (trace < 3 - 1e-9) {
        const Rotation rotation = Rotation::fromMatrix(
            {dot(a.tangent, b.tangent), dot(a.tangent, b.bitangent), dot(a.tangent, b.normal),
             dot(a.bitangent, b.tangent), dot(a.bitangent, b.bitangent), dot(a.bitangent, b.normal),
             dot(a.normal, b.tangent), dot(a.normal, b.bitangent), dot(a.normal, b.normal)});
        const auto slots = static_cast<std::size_t>(functions.basis()->slots());
        std::vector<double> full(material.channels * slots);
        for (std::size_t c = 0; c < material.channels; ++c) {
            for (std::size_t i = 0; i < size; ++i) {
                full[c * slots + static_cast<std::size_t>(functions.slots()[i])] =
                    static_cast<double>(lobe[c * size + i]);
            }
        }
        full = turning_->of(material.kind, *functions.basis()).values(rotation, full);
        turned.resize(lobe.size());
        for (std::size_t c = 0; c < material.channels; ++c) {
            for (std::size_t i = 0; i < size; ++i) {
                turned[c * size + i] = static_cast<float>(
                    full[c * slots + static_cast<std::size_t>(functions.slots()[i])]);
            }
        }
        weights = &turned;
    }
    const Direction gap = between(record.position, hit.position);
    const auto x = static_cast<float>(dot(gap, a.tangent));
    const auto y = static_cast<float>(dot(gap, a.bitangent));
    for (std::size_t c = 0; c < 3; ++c) {
        const float* light = record.part(0, size).data() + c * size;
        const float* alongX = record.part(1, size).data() + c * size;
        const float* alongY = record.part(2, size).data() + c * size;
        const float* f = weights->data() + (material.channels == 1 ? 0 : c * size);
        float dotProduct = 0;
        for (std::size_t i = 0; i < size; ++i)
            dotProduct += f[i] * (light[i] + x * alongX[i] + y * alongY[i]);
        sum[c] += near.weight * static_cast<double>(dotProduct);
    }
}

std::size_t RadianceCache::bytes() const {
    return valueBytes_ + records_.size() * recordOverhead;
}

bool RadianceCache::full() const {
    std::size_t largest = 0;
    for (const IncomingFunctions& functions : materials_.kinds)
        largest = std::max(largest, Record::valuesOf(functions) * sizeof(float));
    return bytes() + largest + recordOverhead > options_.mostBytes;
}

void RadianceCache::make(const std::vector<SurfaceHit>& hits, const std::vector<double>& heights) {
    std::vector<Gathered> made(hits.size());
    std::vector<std::size_t> rays(hits.size());
    const std::size_t first = records_.size();
    tbb::parallel_for(std::size_t{0}, hits.size(), [&](std::size_t k) {
        made[k] = gatheredAt(hits[k], heights[k], first + k, rays[k]);
    });
    for (std::size_t k = 0; k < hits.size(); ++k) {
        rays_ += rays[k];
        if (made[k].sound && !full()) add(std::move(made[k]), heights[k]);
    }
}

/// The least radius of a record where the picture has that height.
double RadianceCache::leastRadius(double height) const {
    return std::max(options_.leastReach * height, 4 * scene().rounding()) / options_.accuracy;
}

Gathered RadianceCache::gatheredAt(const SurfaceHit& hit, double height, std::uint64_t n,
                                   std::size_t& rays) const {
    const std::uint32_t kind = materials_.materials[scene().objects()[hit.object].material].kind;
    const double least = leastRadius(height), reach = options_.accuracy * least;
    const GatherScene gathering{&walk_, surfaces_.get(), reach};
    std::optional<SurfaceHit> place = placeOfRecord(scene(), hit, reach / 2);
    if (place) {
        const Record there{.position = place->position,
                           .frame = place->frame,
                           .radius = least,
                           .longRadius = least};
        if (!(errorOf(there, hit.position, hit.frame.normal) < options_.accuracy)) place.reset();
    }
    // The key lies beyond the keys of the surfaces' points, whatever their number.
    const RandomNumbers random(options_.seed, (std::uint64_t{1} << 40) + n);
    return gather(place.value_or(hit), kind, materials_.kinds[kind], strata_[kind],
                  options_.gradient, gathering, random, rays);
}

/// Sets the radii by the record alone; returns the least radius.
double RadianceCache::limit(Gathered& gathered, double height) const {
    Record& record = gathered.record;
    const double least = leastRadius(height);
    if (gathered.bends.empty()) {
        limitByDistance(record);
    } else {
        limitByBends(record, gathered.bends, height);
    }
    if (!(record.radius < least)) return least;
    // Where the reach cannot be as small as it should, the gradient is made smaller (Tabellion &
    // Lamorlette 2004).
    const std::size_t size = materials_.kinds[record.kind].size();
    const auto factor = static_cast<float>(record.radius / least);
    for (const std::size_t part : {1U, 2U})
        for (float& value : record.part(part, size)) value *= factor;
    record.radius = least;
    record.longRadius = std::max(record.longRadius, least);
    return least;
}

void RadianceCache::add(Gathered gathered, double height) {
    const double least = limit(gathered, height);
    if (options_.neighbourClamping) clampByNeighbours(gathered.record, least);
    store(std::move(gathered.record));
}

RadianceCache::Trial RadianceCache::trial(const SurfaceHit& hit, double height,
                                          std::uint64_t n) const {
    Trial trial;
    Gathered gathered = gatheredAt(hit, height, n, trial.rays);
    limit(gathered, height);
    trial.radius = gathered.record.radius;
    trial.longRadius = gathered.record.longRadius;
    const MaterialLight& material = materials_.materials[scene().objects()[hit.object].material];
    std::vector<float> lobe(material.channels * materials_.kinds[material.kind].size());
    material.at(materials_.kinds[material.kind], hit.wo, lobe.data());
    addDotProduct({&gathered.record, 1}, hit, material, lobe, trial.radiance);
    return trial;
}

Rgb RadianceCache::sampled(const SurfaceHit& hit, RandomNumbers& random, std::size_t& rays) const {
    const KnownLight known = [&](const SurfaceHit& end, bool last) {
        return surfaces_->at(end, last);
    };
    return walk_.sampled(hit, known, options_.direct == DirectLight::gathered, random, rays)
        .radiance;
}

int RadianceCache::walksAt(const SurfaceHit& hit) const {
    return materials_.materials[scene().objects()[hit.object].material].walks;
}

void RadianceCache::sample(std::size_t material, int walks) {
    MaterialLight& light = materials_.materials[material];
    light.way = LightWay::sampled;
    light.walks = walks;
    light.reason = "at less predicted cost than by coefficients";
}

void RadianceCache::limitByDistance(Record& record) const {
    const std::size_t size = materials_.kinds[record.kind].size();
    record.radius = std::min(record.distance, 2 * extent_);
    if (options_.gradientLimit && options_.gradient != Gradient::none) {
        const double slope = std::hypot(normOf(record.part(1, size)), normOf(record.part(2, size)));
        if (slope > 0)
            record.radius = std::min(record.radius, normOf(record.part(0, size)) / slope);
    }
    record.longRadius = record.radius;
}

/// Limits the reach by second derivatives. Along an eigenvector of the sum of their squared
/// matrices, with the eigenvalue s^2, extrapolation over x misses by s x^2 / 2.
void RadianceCache::limitByBends(Record& record, const std::vector<float>& bends,
                                 double height) const {
    const std::size_t size = materials_.kinds[record.kind].size();
    double xx = 0, xy = 0, yy = 0, squares = 0;
    for (std::size_t i = 0; i < size; ++i) {
        const auto bend = [&](std::size_t k) { return static_cast<double>(bends[k * size + i]); };
        xx += bend(0) * bend(0) + bend(1) * bend(1);
        xy += bend(1) * (bend(0) + bend(2));
        yy += bend(1) * bend(1) + bend(2) * bend(2);
        const std::span<const float> light = record.part(0, size);
        const double sum = static_cast<double>(light[i] + light[size + i] + light[2 * size + i]);
        squares += sum * sum;
    }
    const double mean = (xx + yy) / 2, half = std::hypot((xx - yy) / 2, xy);
    const auto radiusOf = [&](double square) {
        if (!(square > 0)) return 2 * extent_;
        const double whole = std::sqrt(2 * std::sqrt(squares / square));
        return std::min(2 * extent_, std::sqrt(whole * evenness * height));
    };
    record.radius = radiusOf(mean + half);
    record.longRadius = std::min(radiusOf(mean - half), mostStretch * record.radius);
    const double angle = std::atan2(-2 * xy, yy - xx) / 2;
    record.longAxis = record.frame.toWorld({std::cos(angle), std::sin(angle), 0});
}

void RadianceCache::clampByNeighbours(Record& record, double least) {
    std::vector<std::uint32_t> found;
    index_[record.kind].near(record.position, options_.accuracy * record.longRadius, found);
    std::erase_if(found, [&](std::uint32_t k) {
        return dot(record.frame.normal, records_[k].frame.normal) < 0.9;
    });
    for (const std::uint32_t k : found) {
        const double gap = lengthOf(between(record.position, records_[k].position));
        record.radius = std::max(least, std::min(record.radius, records_[k].radius + gap));
        record.longRadius =
            std::max(least, std::min(record.longRadius, records_[k].longRadius + gap));
    }
    for (const std::uint32_t k : found) {
        if (k < settled_) continue;
        const double gap = lengthOf(between(record.position, records_[k].position));
        records_[k].radius = std::min(records_[k].radius, record.radius + gap);
        records_[k].longRadius = std::min(records_[k].longRadius, record.longRadius + gap);
    }
}

void RadianceCache::store(Record record) {
    valueBytes_ += record.values.size() * sizeof(float);
    const auto number = static_cast<std::uint32_t>(records_.size());
    index_[record.kind].add(number, record.position, options_.accuracy * record.longRadius);
    records_.push_back(std::move(record));
}

}  // namespace hshfit::inline transport::inline radiance_cache
