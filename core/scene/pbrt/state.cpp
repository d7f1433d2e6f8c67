#include "core/scene/pbrt/state.h"

#include <fmt/format.h>

#include "core/config/suggest.h"
#include "core/scene/loading/transform.h"

namespace ulam::pbrt {
namespace {

constexpr size_t kDeepest = 1024;  // attributes inside attributes

Vec3d vector(Tokens& tokens, std::string_view what) {
    const double x = tokens.number(what), y = tokens.number(what), z = tokens.number(what);
    return {x, y, z};
}

/// pbrt writes the columns of matrices for column vectors one after another: the rows of those for row vectors.
Matrix4 matrix(Tokens& tokens, std::string_view directive) {
    if (tokens.peek().kind != Token::Kind::Open) tokens.unexpected(tokens.next(), "\"[\" and 16 numbers");
    tokens.next();
    Matrix4 m;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) m[row][column] = tokens.number(directive);
    if (tokens.peek().kind != Token::Kind::Close) tokens.unexpected(tokens.next(), "\"]\" after 16 numbers");
    tokens.next();
    return m;
}

Matrix4 lookAt(const Vec3d& eye, const Vec3d& target, const Vec3d& up, const Place& place) {
    const Vec3d view = (target - eye).normalized(), right = up.normalized().cross(view);
    if (!(right.length() > 1e-9))
        refuse(place, "LookAt needs an eye, a target and a direction up that is not along the view");
    const Vec3d x = right.normalized(), y = view.cross(x);
    const Matrix4 cameraToWorld(x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, view.x, view.y, view.z, 0, eye.x, eye.y, eye.z, 1);
    return cameraToWorld.inverse();
}

}  // namespace

const std::vector<std::string>& GraphicsStates::directives() {
    static const std::vector<std::string> names{"ActiveTransform",
                                                "AttributeBegin",
                                                "AttributeEnd",
                                                "ConcatTransform",
                                                "CoordinateSystem",
                                                "CoordSysTransform",
                                                "Identity",
                                                "LookAt",
                                                "ReverseOrientation",
                                                "Rotate",
                                                "Scale",
                                                "Transform",
                                                "TransformBegin",
                                                "TransformEnd",
                                                "TransformTimes",
                                                "Translate"};
    return names;
}

void GraphicsStates::transform(const Matrix4& m, const Place& place) {
    // What is written later is applied first.
    now.toWorld = m * now.toWorld;
    const Matrix4& all = now.toWorld;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            if (!(std::abs(all[row][column]) <= kLargestCoordinate))
                refuse(place, fmt::format("the transformation is not finite, or beyond {:g}", kLargestCoordinate));
    const double size = Vec3d(all[0][0], all[0][1], all[0][2]).length() *
                        Vec3d(all[1][0], all[1][1], all[1][2]).length() *
                        Vec3d(all[2][0], all[2][1], all[2][2]).length();
    if (!(std::abs(linearDeterminant(all)) > 1e-12 * size)) refuse(place, "the transformation is not invertible");
    if (all[0][3] != 0 || all[1][3] != 0 || all[2][3] != 0 || all[3][3] != 1)
        refuse(place, "the transformation is not affine");
}

bool GraphicsStates::read(std::string_view directive, Tokens& tokens, const Place& place) {
    Matrix4 m;
    if (directive == "AttributeBegin") {
        push("Attribute", place);
    } else if (directive == "AttributeEnd") {
        pop("Attribute", place);
    } else if (directive == "TransformBegin") {
        push("Transform", place);
    } else if (directive == "TransformEnd") {
        pop("Transform", place);
    } else if (directive == "ReverseOrientation") {
        now.reversed = !now.reversed;
    } else if (directive == "Identity") {
        now.toWorld = Matrix4();
    } else if (directive == "Translate") {
        transform(m.setTranslation(vector(tokens, "Translate")), place);
    } else if (directive == "Scale") {
        transform(m.setScale(vector(tokens, "Scale")), place);
    } else if (directive == "Rotate") {
        const double angle = tokens.number("Rotate");
        const Vec3d axis = vector(tokens, "Rotate");
        if (!(axis.length() > 0)) refuse(place, "the axis of Rotate has no length");
        transform(m.setAxisAngle(axis, angle * kPi / 180), place);
    } else if (directive == "LookAt") {
        const Vec3d eye = vector(tokens, "LookAt"), target = vector(tokens, "LookAt"), up = vector(tokens, "LookAt");
        transform(lookAt(eye, target, up, place), place);
    } else if (directive == "Transform") {
        m = matrix(tokens, "Transform");
        now.toWorld = Matrix4();
        transform(m, place);
    } else if (directive == "ConcatTransform") {
        transform(matrix(tokens, "ConcatTransform"), place);
    } else if (directive == "CoordinateSystem") {
        nameCoordinates(tokens.text("a name"));
    } else if (directive == "CoordSysTransform") {
        const std::string name = tokens.text("a name");
        const auto found = coordinates_.find(name);
        std::vector<std::string> names;
        for (const auto& known : coordinates_) names.push_back(known.first);
        if (found == coordinates_.end()) unknownName("coordinate system", name, names, place.text());
        now.toWorld = found->second;
    } else if (directive == "ActiveTransform") {
        const Token which = tokens.next();
        if (which.text != "All" && which.text != "StartTime" && which.text != "EndTime")
            tokens.unexpected(which, "All, StartTime or EndTime");
        if (which.text != "All") refuse(place, "moving scenes are not supported", "ActiveTransform All is");
    } else if (directive == "TransformTimes") {
        tokens.number("TransformTimes"), tokens.number("TransformTimes");  // nothing moves
    } else {
        return false;
    }
    return true;
}

void GraphicsStates::push(const std::string& kind, const Place& place) {
    if (stack_.size() >= kDeepest) refuse(place, fmt::format("{}Begin is nested deeper than {}", kind, kDeepest));
    stack_.push_back({kind, now, place});
}

void GraphicsStates::pop(const std::string& kind, const Place& place) {
    if (stack_.empty()) refuse(place, fmt::format("there is no {0}Begin for this {0}End", kind));
    Saved& saved = stack_.back();
    if (saved.kind != kind)
        refuse(place, fmt::format("{} ends inside {}", kind, saved.kind),
               fmt::format("{} begins at {}", saved.kind, saved.place.text()));
    if (kind == "Transform")
        now.toWorld = saved.state.toWorld;
    else
        now = std::move(saved.state);
    stack_.pop_back();
}

void GraphicsStates::needsClosed() const {
    if (!stack_.empty()) refuse(stack_.back().place, fmt::format("{0}Begin has no {0}End", stack_.back().kind));
}

}  // namespace ulam::pbrt
