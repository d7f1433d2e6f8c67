// Backlit grid of holes: a plate with n × n holes, lit from behind, in front of a receiver that the camera looks at. A
// Metropolis chain that has found one hole tends to stay there. Lengths in scene units; the plate's front face is at
// z = 0, the receiver at z = receiver_distance, the light behind.

#include "core/base/error.h"
#include "core/scene/generator.h"
#include "core/scene/loading/materials.h"
#include "experiments/scenes/hole_plate.h"
#include "experiments/scenes/receiver_irradiance.h"
#include "experiments/scenes/receiver_view.h"

namespace ulam {
namespace {

constexpr double kEmitterGap = 0.02;        // behind the plate
constexpr double kReceiverHalfWidth = 0.6;  // of receiver and emitter
constexpr double kChamberHalfWidth = 0.75, kChamberDepth = 0.5, kChamberReflectance = 0.8;
constexpr double kStripInner = 0.575, kStripOuter = 0.725, kStripHalfLength = 0.5;
constexpr double kSmallLightRadius = 0.02, kSmallLightDepth = 0.25;
constexpr double kPaneThickness = 0.01;
constexpr double kWallReflectance = 0.5;
constexpr double kSmallestHole = 1e-5;  // radius: single precision still resolves its edges
constexpr double kBrightHole = 16;      // area of the bright hole over that of any other

struct GridOfHolesParameters {
    int holes = 8;
    double pitch = 0, openArea = 0.03, radius = 0, thickness = 0.1;
    std::string shape = "round";
    int polygonSides = 64;
    std::string weights = "equal", back = "emitter";
    double radiance = 0, receiverDistance = 0.4;
    JsonNode plate{diffuse(0)}, receiver{diffuse(0.8)};
    int glassPanes = 0;
    bool room = false;

    template <class V>
    void describe(V& v) {
        v("holes", holes, {.help = "holes a side", .min = 1, .max = 32});
        v("pitch", pitch, {.help = "distance of neighbouring holes' axes; 0: 1/holes", .min = 0, .max = 1});
        v("open_area", openArea, {.help = "area of all holes as a fraction of the plate's", .min = 1e-8, .max = 0.75});
        v("radius", radius,
          {.help = "radius of a hole, in place of open_area; 0: from open_area", .min = 0, .max = 0.5});
        v("thickness", thickness, {.help = "thickness of the plate", .min = 0, .max = 2});
        v("shape", shape, {.help = "cross-section of the holes", .choices = {"round", "square"}});
        v("polygon_sides", polygonSides,
          {.help = "sides of the polygon that a round hole is, of the circle's area", .min = 4, .max = 512});
        v("weights", weights,
          {.help = "areas of the holes: equal; halved from column to column; or one of 16 times the others' area",
           .choices = {"equal", "geometric", "one_bright"}});
        v("back", back,
          {.help = "light right behind the plate; hidden from the holes in a diffuse chamber; or a small disc in that "
                   "chamber",
           .choices = {"emitter", "hidden", "small"}});
        v("radiance", radiance,
          {.help = "of the emitter; 0: chosen so that the image's mean is near 0.5", .unit = "W/(m² sr)", .min = 0});
        v("receiver_distance", receiverDistance,
          {.help = "from the plate's front to the receiver", .min = 0.02, .max = 10});
        v("plate", plate, {.help = "BSDF of the plate"});
        v("receiver", receiver, {.help = "BSDF of the receiver"});
        v("glass_panes", glassPanes, {.help = "panes of glass between plate and receiver", .min = 0, .max = 4});
        v("room", room, {.help = "close the sides between plate and receiver with diffuse walls"});
    }
};

/// A generator's parameters stand outside of any scene.
struct NoScene : PluginResolver {
    JsonNode resolve(const JsonNode& node) override { return node; }
    bool isTexture(const JsonNode&) const override { return false; }
    uint32_t texture(const JsonNode& node, const ParameterInfo&) override { node.fail("a generator's BSDF takes no texture"); }
};

/// Reflectance of a plain diffuse BSDF.
std::optional<Spectrum> diffuseReflectance(const JsonNode& bsdf) {
    NoScene none;
    const Material material = readMaterial(bsdf, none);
    const auto* plain = std::get_if<TexturedBsdf>(&material.front.layer);
    const auto* diffuse = plain ? std::get_if<Diffuse>(&plain->bsdf) : nullptr;
    return diffuse ? std::optional(diffuse->reflectance) : std::nullopt;
}

class GridOfHoles : public Generator {
public:
    using Parameters = GridOfHolesParameters;
    explicit GridOfHoles(const Parameters& parameters);

    Json expand() const override;
    Features features() const override;
    std::optional<Image> truth(const FilmSize& film) const override;
    std::vector<double> featureShares() const override;

private:
    double holeArea(int row, int column) const;
    double front() const { return p_.receiverDistance; }
    double rear() const { return -p_.thickness; }
    double holeRadius(int row, int column) const { return std::sqrt(holeArea(row, column) / kPi); }
    double meanPerRadiance() const;
    bool isSolvable(const FilmSize& film) const;
    void addEmitter(Json& scene) const;
    void addChamber(Json& scene) const;
    void addSurroundings(Json& scene) const;

    Parameters p_;
    HolePlate plate_;
    ReceiverView view_;
    double unitArea_ = 0;  // of a hole of weight 1
    double radiance_ = 0;
    Spectrum receiverReflectance_{0, 0, 0};
    bool exactMaterials_ = false;  // black plate and plain diffuse receiver
};

double weight(const GridOfHolesParameters& p, int row, int column) {
    if (p.weights == "geometric") return std::ldexp(1.0, -column);
    if (p.weights == "one_bright") return row == p.holes / 2 && column == p.holes / 2 ? kBrightHole : 1;
    return 1;
}

double GridOfHoles::holeArea(int row, int column) const {
    return unitArea_ * weight(p_, row, column);
}

GridOfHoles::GridOfHoles(const Parameters& parameters) : p_(parameters) {
    const double pitch = p_.pitch > 0 ? p_.pitch : 1.0 / p_.holes;
    if (p_.holes * pitch > 1 + 1e-9)
        fail(ExitCode::InvalidConfig, "grid_of_holes: {} holes of pitch {} are wider than the plate, which is 1 wide",
             p_.holes, pitch);
    double weights = 0;
    for (int row = 0; row < p_.holes; ++row)
        for (int column = 0; column < p_.holes; ++column) weights += weight(p_, row, column);
    const double openArea = p_.radius > 0 ? kPi * p_.radius * p_.radius * p_.holes * p_.holes : p_.openArea;
    unitArea_ = openArea / weights;

    // The emitter is wider than the unit square: the plate is so too, so that light passes through the holes only.
    plate_ = {p_.holes, pitch, p_.thickness, p_.back == "emitter" ? kReceiverHalfWidth : 0.5, {}};
    const bool square = p_.shape == "square";
    for (int row = 0; row < p_.holes; ++row)
        for (int column = 0; column < p_.holes; ++column) {
            plate_.outlines.push_back(
                regularPolygon({0, 0}, holeArea(row, column), square ? 4 : p_.polygonSides, square ? kPi / 4 : 0));
            if (holeRadius(row, column) < kSmallestHole)
                fail(ExitCode::InvalidConfig, "grid_of_holes: hole_{}_{} has a radius of {:.3g}, less than {}", row,
                     column, holeRadius(row, column), kSmallestHole);
            for (const Imath::V2d& corner : plate_.outlines.back())
                if (std::max(std::abs(corner.x), std::abs(corner.y)) > pitch * 0.499)
                    fail(ExitCode::InvalidConfig,
                         "grid_of_holes: hole_{}_{} reaches {:.4g} from its axis, which does not fit into the pitch "
                         "{:.4g}: reduce open_area or radius",
                         row, column, std::max(std::abs(corner.x), std::abs(corner.y)), pitch);
        }
    // An odd number of holes has one in the middle: the pinhole stands between it and the next.
    view_ = {p_.receiverDistance, p_.holes % 2 == 1 ? pitch / 2 : 0};
    const auto plate = diffuseReflectance(p_.plate), receiver = diffuseReflectance(p_.receiver);
    exactMaterials_ = plate && isBlack(*plate) && receiver;
    receiverReflectance_ = receiver.value_or(Spectrum(0.5));
    radiance_ = p_.radiance > 0 ? p_.radiance : 0.5 / meanPerRadiance();
}

/// About the image's mean for radiance 1: flux through the holes that reaches the unit square of the receiver.
double GridOfHoles::meanPerRadiance() const {
    const double chamberArea = 8 * kChamberHalfWidth * (kChamberHalfWidth + kChamberDepth);
    // Plate and strips take light away; the rest is an integrating sphere.
    const double lost = 1 + 4 * kStripHalfLength * (kStripOuter - kStripInner);
    const double cavityGain =
        kChamberReflectance / (kPi * chamberArea * (1 - kChamberReflectance * (1 - lost / chamberArea)));
    const Polygon unitSquare = regularPolygon({0, 0}, 1, 4, kPi / 4);
    const double onPlate = lambertIrradiance(unitSquare, kSmallLightDepth) / kPi;
    const double lightArea = kPi * kSmallLightRadius * kSmallLightRadius;
    const double stripFlux = kPi * 4 * kStripHalfLength * (kStripOuter - kStripInner);
    const double diffuseRadiance = p_.back == "emitter"  ? 1
                                   : p_.back == "hidden" ? stripFlux * cavityGain
                                                         : kPi * lightArea * (1 - onPlate) * cavityGain;
    const double onSquare = lambertIrradiance(unitSquare, p_.receiverDistance) / kPi;
    double flux = 0;
    for (int row = 0; row < p_.holes; ++row)
        for (int column = 0; column < p_.holes; ++column) {
            const double area = holeArea(row, column), r = holeRadius(row, column), ratio = p_.thickness / r;
            // Form factor of two equal parallel discs (Howell's catalogue, C-40).
            const double x = 2 + ratio * ratio, passed = (x - std::sqrt(x * x - 4)) / 2;
            flux += diffuseRadiance * kPi * area * std::min(passed, onSquare);
            if (p_.back != "small") continue;
            const double offset = plate_.axis(row, column).length(),
                         d2 = offset * offset + kSmallLightDepth * kSmallLightDepth;
            const double cosine2 = kSmallLightDepth * kSmallLightDepth / d2;
            const double shift = offset * p_.thickness / kSmallLightDepth;
            flux += lightArea * cosine2 * cosine2 / (kSmallLightDepth * kSmallLightDepth) * area *
                    std::max(0.0, 1 - shift / (2 * r));
        }
    return std::max(1e-30, luminance(receiverReflectance_) / kPi * flux);
}

Json GridOfHoles::expand() const {
    Json scene = {{"type", "scene"}, {"sensor", view_.sensor()}, {"plate", plate_.mesh().shape(p_.plate.json())}};
    const double w = kReceiverHalfWidth;
    MeshBuilder receiver;
    receiver.quad({-w, -w, front()}, {-w, w, front()}, {w, w, front()}, {w, -w, front()});
    scene["receiver"] = receiver.shape(p_.receiver.json());
    if (p_.back == "emitter")
        addEmitter(scene);
    else
        addChamber(scene);
    addSurroundings(scene);
    return scene;
}

void GridOfHoles::addEmitter(Json& scene) const {
    const double w = kReceiverHalfWidth, z = rear() - kEmitterGap;
    MeshBuilder light;
    light.quad({-w, -w, z}, {w, -w, z}, {w, w, z}, {-w, w, z});
    scene["light"] = emitting(light.shape(diffuse(0)), radiance_);
}

/// A box behind the plate, open to it only through the holes.
void GridOfHoles::addChamber(Json& scene) const {
    const double w = kChamberHalfWidth, h = plate_.halfWidth, z1 = rear(), z0 = rear() - kChamberDepth;
    MeshBuilder chamber;
    chamber.quad({-w, -w, z0}, {w, -w, z0}, {w, w, z0}, {-w, w, z0});
    chamber.quad({-w, -w, z0}, {-w, w, z0}, {-w, w, z1}, {-w, -w, z1});
    chamber.quad({w, -w, z0}, {w, -w, z1}, {w, w, z1}, {w, w, z0});
    chamber.quad({-w, -w, z0}, {-w, -w, z1}, {w, -w, z1}, {w, -w, z0});
    chamber.quad({-w, w, z0}, {w, w, z0}, {w, w, z1}, {-w, w, z1});
    // The front, around the plate.
    chamber.quad({-w, -w, z1}, {-h, -h, z1}, {h, -h, z1}, {w, -w, z1});
    chamber.quad({w, -w, z1}, {h, -h, z1}, {h, h, z1}, {w, w, z1});
    chamber.quad({w, w, z1}, {h, h, z1}, {-h, h, z1}, {-w, w, z1});
    chamber.quad({-w, w, z1}, {-h, h, z1}, {-h, -h, z1}, {-w, -w, z1});
    scene["chamber"] = chamber.shape(diffuse(kChamberReflectance));

    MeshBuilder light;
    if (p_.back == "hidden") {
        // Just behind the chamber's front and facing away from it.
        const double z = z1 - 0.001, l = kStripHalfLength;
        for (const auto& [x0, x1] : {std::pair(-kStripOuter, -kStripInner), std::pair(kStripInner, kStripOuter)})
            light.quad({x0, -l, z}, {x0, l, z}, {x1, l, z}, {x1, -l, z});
    } else {
        std::vector<Vec3d> corners;
        for (const Imath::V2d& p : regularPolygon({0, 0}, kPi * kSmallLightRadius * kSmallLightRadius, 32, 0))
            corners.emplace_back(p.x, p.y, z1 - kSmallLightDepth);
        light.polygon(corners);
    }
    scene["light"] = emitting(light.shape(diffuse(0)), radiance_);
}

void GridOfHoles::addSurroundings(Json& scene) const {
    const double w = kReceiverHalfWidth, z0 = rear(), z1 = front();
    if (p_.room) {
        MeshBuilder walls;
        walls.quad({-w, -w, z0}, {-w, w, z0}, {-w, w, z1}, {-w, -w, z1});
        walls.quad({w, -w, z0}, {w, -w, z1}, {w, w, z1}, {w, w, z0});
        walls.quad({-w, -w, z0}, {-w, -w, z1}, {w, -w, z1}, {w, -w, z0});
        walls.quad({-w, w, z0}, {w, w, z0}, {w, w, z1}, {-w, w, z1});
        scene["room"] = walls.shape(diffuse(kWallReflectance));
    }
    for (int i = 0; i < p_.glassPanes; ++i) {
        const double z = front() * (i + 1) / (p_.glassPanes + 1);
        // A little smaller than the room, so that no faces coincide.
        scene[fmt::format("pane_{}", i)] = {
            {"type", "cube"},
            {"to_world", Json::array({{{"type", "scale"}, {"value", {0.999 * w, 0.999 * w, kPaneThickness / 2}}},
                                      {{"type", "translate"}, {"value", {0.0, 0.0, z}}}})},
            {"bsdf", {{"type", "dielectric"}}}};
    }
}

Features GridOfHoles::features() const {
    // Inside the plate, or just behind a sheet: light that is reflected by the plate's front does not cross it.
    const float half = float(p_.holes * plate_.pitch / 2), z = -float(std::max(p_.thickness / 2, 1e-4));
    Features features{{half, half, z}, {-2 * half, 0, 0}, {0, -2 * half, 0}, p_.holes, p_.holes, {}};
    for (int row = 0; row < p_.holes; ++row)
        for (int column = 0; column < p_.holes; ++column)
            features.names.push_back(fmt::format("hole_{}_{}", row, column));
    return features;
}

/// Direct light of an emitter that is seen through the holes as if it had no end, and nothing else.
bool GridOfHoles::isSolvable(const FilmSize& film) const {
    if (p_.back != "emitter" || !exactMaterials_ || p_.room || p_.glassPanes > 0) return false;
    const ReceiverView::Square image = view_.image(film);
    const double seen = std::max({std::abs(image.x0), std::abs(image.x1), std::abs(image.y0), std::abs(image.y1)});
    if (seen > kReceiverHalfWidth) return false;
    const double hole = p_.holes * plate_.pitch / 2, depth = p_.receiverDistance + p_.thickness;
    return hole + (hole + seen) * kEmitterGap / depth < kReceiverHalfWidth;
}

std::optional<Image> GridOfHoles::truth(const FilmSize& film) const {
    if (!isSolvable(film)) return std::nullopt;
    ReceiverIrradiance irradiance(plate_, p_.receiverDistance);
    Image image(film.cropWidth, film.cropHeight);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const ReceiverView::Square square = view_.pixel(film, x, y);
            double sum = 0;
            for (size_t hole = 0; hole < plate_.outlines.size(); ++hole) sum += irradiance.mean(hole, square);
            image.at(x, y) = Rgb(receiverReflectance_ * (sum * radiance_ / kPi));
        }
    return image;
}

std::vector<double> GridOfHoles::featureShares() const {
    const int n = std::max(32, 4 * p_.holes);
    const FilmSize film{n, n, 0, 0, n, n};
    if (!isSolvable(film)) return {};
    ReceiverIrradiance irradiance(plate_, p_.receiverDistance);
    std::vector<double> shares(plate_.outlines.size(), 0);
    double total = 0;
    for (size_t hole = 0; hole < shares.size(); ++hole) {
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) shares[hole] += irradiance.mean(hole, view_.pixel(film, x, y));
        total += shares[hole];
    }
    for (double& share : shares) share /= total;
    return shares;
}

}  // namespace

ULAM_REGISTER_GENERATOR(GridOfHoles, "grid_of_holes",
                        "plate with a grid of holes, lit from behind: chains get caught by single holes");

}  // namespace ulam
