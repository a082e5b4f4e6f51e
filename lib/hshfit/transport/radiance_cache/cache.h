#pragma once

#include <hshfit/transport/radiance_cache/material_light.h>
#include <hshfit/transport/radiance_cache/record.h>
#include <hshfit/transport/radiance_cache/record_file.h>
#include <hshfit/transport/radiance_cache/record_index.h>

#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

namespace hshfit::inline transport::inline radiance_cache {

/// Defaults give the smallest error for the time; the paper's are `asPublished`.
struct CacheOptions {
    MaterialChoiceOptions choice = {};
    int rays = 2000;        ///< of a record, at most (HemisphereStrata)
    double accuracy = 0.3;  ///< a of Eq. 23: a record counts where its weight is above 1 / a
    int fewestBounces = 0;  ///< as PathOptions::fewestBounces, up to 2
    int mostBounces = 1000;
    DirectLight direct = DirectLight::sampled;
    Gradient gradient = Gradient::strata;
    /// R_i at most the coefficients over their gradient, by norms (Ward & Heckbert 1992).
    bool gradientLimit = true;
    /// R_i at most R_j + |p_i - p_j| (Křivánek et al. 2006).
    bool neighbourClamping = true;
    /// R_i from second derivatives by the rays (Jarosz et al. 2012, Schwarzhaupt et al. 2012),
    /// larger along one axis, in place of distance and gradientLimit. Not without a gradient.
    bool errorControl = true;
    /// The least reach of a record, as a share of the picture's height at its distance.
    double leastReach = 0.02;
    std::size_t surfacePoints = 4096;
    int surfaceRays = 256;
    std::size_t mostBytes = std::size_t{256} << 20;  ///< of records; then no more are made
    std::uint64_t seed = 1;
    TransportProgress progress = {};  ///< of the light on diffuse surfaces

    /// Gradients by hit points, spacing by harmonic mean distance alone.
    void asPublished();
};

/// The records of a scene: incident radiance where pictures needed it (Gautron et al. 2004, section
/// 6.2). Records are made between look-ups; these may run on many threads.
class RadianceCache {
public:
    /// Chooses for each material, and finds the light on diffuse surfaces. Throws UsageError for
    /// settings outside of their range and as chooseLight does. The scene has to outlive this.
    RadianceCache(const SurfaceScene& scene, const CacheOptions& options);
    /// A cache that begins with records of the same scene and settings. Throws InputError where
    /// they do not fit.
    RadianceCache(const SurfaceScene& scene, const CacheOptions& options, StoredRecords stored);
    ~RadianceCache();

    /// Indirect radiance (with gathered light: all that is reflected) towards hit.wo by the records
    /// about a hit; false where none reaches it. `reach` widens all records.
    bool radiance(const SurfaceHit& hit, Rgb& radiance, double reach = 1) const;
    bool covers(const SurfaceHit& hit) const;
    /// Whether the hit's material takes records.
    bool takesRecords(const SurfaceHit& hit) const;

    /// Indirect radiance (with gathered light: all that is reflected) towards hit.wo by one walk of
    /// the material's sampler; adds the rays traced.
    Rgb sampled(const SurfaceHit& hit, RandomNumbers& random, std::size_t& rays) const;
    /// Walks of a line of sight that ends here, where it is sampled.
    int walksAt(const SurfaceHit& hit) const;
    /// Has a material sampled from now on, by so many walks for each line of sight.
    void sample(std::size_t material, int walks);
    /// A record as `make` makes the n-th where there are no others, with the radiance by it towards
    /// hit.wo. It is not kept.
    struct Trial {
        double radius = 0, longRadius = 0;
        Rgb radiance{};
        std::size_t rays = 0;
    };
    Trial trial(const SurfaceHit& hit, double height, std::uint64_t n) const;

    /// Makes records at hits at once, in parallel, and adds them in that order. `heights` are
    /// the picture's there. None is added where its numbers are not finite, or its rays
    /// would start on another surface.
    void make(const std::vector<SurfaceHit>& hits, const std::vector<double>& heights);
    /// Keeps the reach of the records as it is: what they cover stays covered when more are made.
    void settle() { settled_ = records_.size(); }
    /// Whether the largest record would go beyond CacheOptions::mostBytes.
    bool full() const;

    const SurfaceScene& scene() const { return walk_.scene(); }
    const LightWalk& walk() const { return walk_; }
    const CacheOptions& options() const { return options_; }
    const MaterialLights& materials() const { return materials_; }
    const SurfaceIrradiance& surfaces() const { return *surfaces_; }
    const std::deque<Record>& records() const { return records_; }
    std::size_t bytes() const;
    std::size_t rays() const { return rays_; }
    /// A copy for a file.
    StoredRecords stored(const std::string& key) const;

private:
    struct Near {
        const Record* record;
        double weight;
    };
    struct Turning;

    RadianceCache(const SurfaceScene& scene, const CacheOptions& options, StoredRecords* stored);
    double errorOf(const Record& record, const Point& at, const Direction& normal) const;
    std::vector<Near>& near(const SurfaceHit& hit, std::uint32_t kind, double reach) const;
    void add(Gathered gathered, double height);
    void store(Record record);
    void findSurfaces();
    int bouncesOfSurfaces() const;
    double leastRadius(double height) const;
    Gathered gatheredAt(const SurfaceHit& hit, double height, std::uint64_t n,
                        std::size_t& rays) const;
    double limit(Gathered& gathered, double height) const;
    void limitByDistance(Record& record) const;
    void limitByBends(Record& record, const std::vector<float>& bends, double height) const;
    void clampByNeighbours(Record& record, double least);
    void addDotProduct(const Near& near, const SurfaceHit& hit, const MaterialLight& material,
                       const std::vector<float>& lobe, Rgb& sum) const;
    Rgb irradianceAt(const Record& record, const SurfaceHit& hit) const;

    CacheOptions options_;
    LightWalk walk_;
    MaterialLights materials_;
    std::unique_ptr<SurfaceIrradiance> surfaces_;
    std::vector<HemisphereStrata> strata_;  ///< of each kind
    std::vector<RecordIndex> index_;        ///< of each kind
    std::deque<Record> records_;
    std::unique_ptr<Turning> turning_;
    std::size_t rays_ = 0, valueBytes_ = 0;
    std::size_t settled_ = 0;  ///< records whose radii no longer change
    double extent_ = 0;        ///< of the scene, the longest edge of its box
};

}  // namespace hshfit::inline transport::inline radiance_cache
