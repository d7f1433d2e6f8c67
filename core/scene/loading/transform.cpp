#include "core/scene/loading/transform.h"

#include <array>

#include "core/base/warp.h"
#include "core/scene/loading/plugin_table.h"

namespace ulam {
namespace {

constexpr const char* kForms =
    "16 numbers (row-major), 4 rows of 4, or a list of translate, rotate, scale, lookat and matrix steps";

/// From column-vector convention, as users write matrices.
Matrix4 fromRows(const std::vector<double>& rows) {
    Matrix4 m;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) m[column][row] = rows[size_t(4 * row + column)];
    return m;
}

Matrix4 fromAxes(const Vec3d& x, const Vec3d& y, const Vec3d& z, const Vec3d& origin) {
    return {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, origin.x, origin.y, origin.z, 1};
}

Matrix4 translate(const JsonNode& step) {
    step.allowOnly("parameter of translate", {"type", "value"});
    return fromAxes({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, parseVector(step.at("value")));
}

Matrix4 scale(const JsonNode& step) {
    step.allowOnly("parameter of scale", {"type", "value"});
    const JsonNode value = step.at("value");
    const Vec3d s = value.isNumber() ? Vec3d(value.number()) : parseVector(value);
    return fromAxes({s.x, 0, 0}, {0, s.y, 0}, {0, 0, s.z}, {0, 0, 0});
}

Matrix4 rotate(const JsonNode& step) {
    step.allowOnly("parameter of rotate", {"type", "axis", "angle"});
    const JsonNode axis = step.at("axis");
    const Vec3d a = parseVector(axis);
    if (!(a.length() > 0)) axis.expected("an axis longer than 0");
    Matrix4 m;
    m.setAxisAngle(a, step.at("angle").number() * kPi / 180);
    return m;
}

Matrix4 lookAt(const JsonNode& step) {
    step.allowOnly("parameter of lookat", {"type", "origin", "target", "up"});
    const Vec3d origin = parseVector(step.at("origin")), target = parseVector(step.at("target"));
    const Vec3d direction = (target - origin).normalized();
    // Without a direction up any will do; this is Mitsuba 3's.
    const auto given = step.find("up");
    const Vec3d up = given ? parseVector(*given) : Vec3d(Frame(Vec3f(direction)).s);
    const Vec3d left = up.normalized().cross(direction);
    if (!(left.length() > 1e-9)) step.fail("lookat needs origin, target and a direction up that is not along the view");
    const Vec3d x = left.normalized();
    return fromAxes(x, direction.cross(x), direction, origin);
}

Matrix4 matrix(const JsonNode& step) {
    step.allowOnly("parameter of matrix", {"type", "value"});
    return fromRows(step.at("value").numbers(16));
}

struct Step {
    const char* name;
    Matrix4 (*read)(const JsonNode&);
};
constexpr std::array<Step, 5> kSteps{
    {{"translate", translate}, {"rotate", rotate}, {"scale", scale}, {"lookat", lookAt}, {"matrix", matrix}}};

Matrix4 parseStep(const JsonNode& node) {
    const std::string& name = pluginName(node);
    std::vector<std::string> names;
    for (const Step& step : kSteps) {
        if (step.name == name) return step.read(node);
        names.push_back(step.name);
    }
    unknownName("transformation", name, names, node.at("type").where());
}

Matrix4 parseAny(const JsonNode& node) {
    if (node.isObject()) return parseStep(node);
    if (!node.isArray() || node.size() == 0) node.expected(kForms);
    if (node[0].isNumber()) {
        if (node.size() != 16) node.expected(kForms);
        return fromRows(node.numbers());
    }
    if (node[0].isArray()) {
        if (node.size() != 4) node.expected(kForms);
        std::vector<double> rows;
        for (const JsonNode& row : node.elements())
            for (const double value : row.numbers(4)) rows.push_back(value);
        return fromRows(rows);
    }
    Matrix4 m;
    for (const JsonNode& step : node.elements()) m *= parseStep(step);
    return m;
}

Vec3d axis(const Matrix4& m, int i) {
    return {m[i][0], m[i][1], m[i][2]};
}

}  // namespace

Vec3d parseVector(const JsonNode& node) {
    const std::vector<double> v = node.numbers(3);
    for (const double x : v)
        if (std::abs(x) > kLargestCoordinate) node.expected(fmt::format("numbers up to {:g}", kLargestCoordinate));
    return {v[0], v[1], v[2]};
}

double linearDeterminant(const Matrix4& m) {
    return axis(m, 0).dot(axis(m, 1).cross(axis(m, 2)));
}

std::array<Vec3f, 3> axesOf(const Matrix4& m) {
    return {Vec3f(axis(m, 0).normalized()), Vec3f(axis(m, 1).normalized()), Vec3f(axis(m, 2).normalized())};
}

std::optional<double> uniformScale(const Matrix4& m) {
    constexpr double kTolerance = 1e-4;
    const Vec3d x = axis(m, 0), y = axis(m, 1), z = axis(m, 2);
    const double s2 = x.dot(x);
    const double worst = std::max(
        {std::abs(y.dot(y) - s2), std::abs(z.dot(z) - s2), std::abs(x.dot(y)), std::abs(y.dot(z)), std::abs(z.dot(x))});
    if (!(worst <= kTolerance * s2)) return std::nullopt;
    return std::copysign(std::sqrt(s2), linearDeterminant(m));
}

Matrix4 parseTransform(const JsonNode& node) {
    if (node.isNull()) return {};
    const Matrix4 m = parseAny(node);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            if (!(std::abs(m[i][j]) <= kLargestCoordinate))
                node.fail(fmt::format("the transformation is not finite, or beyond {:g}", kLargestCoordinate));
    if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1)
        node.fail("the last row of a transformation must be 0 0 0 1");
    const double size = axis(m, 0).length() * axis(m, 1).length() * axis(m, 2).length();
    if (!(std::abs(linearDeterminant(m)) > 1e-12 * size)) node.fail("the transformation is not invertible");
    return m;
}

}  // namespace ulam
