#include "bound_shader.h"

#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace hshfit::shaders {
namespace {

using gpu::ComputeResource;
using Choice = gpu::DeviceChoice::Kind;

/// Texture units of the samplers that fragment shaders of the tests name.
constexpr std::pair<const char*, GLint> esSamplers[] = {
    {"hsh_coefficients", 0},
    {"hsh_map", 0},
    {"hsh_coefficients_table", 0},
    {"hsh_splitSum_table", 0},
    {"hsh_ltc_table", 0},
    {"hsh_prefiltered_table", 0},
    {"hsh_basis", 1},
    {"hsh_shared", 1},
    {"hsh_splitSum_cube", 1},
    {"hsh_prefiltered_cube", 1},
    {"wos", 2},
    {"wis", 3},
    {"lights", 4},
    {"places", 6},
    {"hsh_harmonics", 7},
};
constexpr GLenum unitOfTargets = 8;

/// An OpenGL function by its name; `Type` is its PFN…PROC.
template <class Type>
Type function(const char* name) {
    const auto found = reinterpret_cast<Type>(eglGetProcAddress(name));
    if (found == nullptr) throw Missing(std::string("OpenGL lacks ") + name);
    return found;
}
#define GL(type, name) function<type>(#name)

/// The objects of one run, deleted at its end.
struct Objects {
    std::vector<GLuint> textures, buffers, frames, shaders, programs;
    GLuint output = 0;  ///< the buffer that a compute shader writes

    Objects() = default;
    Objects(const Objects&) = delete;
    Objects& operator=(const Objects&) = delete;
    ~Objects() {
        const auto size = [](const auto& names) { return static_cast<GLsizei>(names.size()); };
        GL(PFNGLDELETETEXTURESPROC, glDeleteTextures)(size(textures), textures.data());
        GL(PFNGLDELETEBUFFERSPROC, glDeleteBuffers)(size(buffers), buffers.data());
        if (!frames.empty())
            GL(PFNGLDELETEFRAMEBUFFERSPROC, glDeleteFramebuffers)(size(frames), frames.data());
        for (const GLuint name : shaders) GL(PFNGLDELETESHADERPROC, glDeleteShader)(name);
        for (const GLuint name : programs) GL(PFNGLDELETEPROGRAMPROC, glDeleteProgram)(name);
    }
};

std::string logOf(GLuint object, bool program) {
    std::array<char, 4096> text{};
    if (program)
        GL(PFNGLGETPROGRAMINFOLOGPROC, glGetProgramInfoLog)(object, 4095, nullptr, text.data());
    else
        GL(PFNGLGETSHADERINFOLOGPROC, glGetShaderInfoLog)(object, 4095, nullptr, text.data());
    return text.data();
}

void addShader(GLenum stage, const std::string& source, Objects& objects) {
    const GLuint shader = GL(PFNGLCREATESHADERPROC, glCreateShader)(stage);
    objects.shaders.push_back(shader);
    const char* text = source.c_str();
    GL(PFNGLSHADERSOURCEPROC, glShaderSource)(shader, 1, &text, nullptr);
    GL(PFNGLCOMPILESHADERPROC, glCompileShader)(shader);
    GLint good = 0;
    GL(PFNGLGETSHADERIVPROC, glGetShaderiv)(shader, GL_COMPILE_STATUS, &good);
    if (good == 0) throw Refused(logOf(shader, false));
}

/// The program of all shaders, in use.
GLuint link(Objects& objects) {
    const GLuint program = GL(PFNGLCREATEPROGRAMPROC, glCreateProgram)();
    objects.programs.push_back(program);
    for (const GLuint shader : objects.shaders)
        GL(PFNGLATTACHSHADERPROC, glAttachShader)(program, shader);
    GL(PFNGLLINKPROGRAMPROC, glLinkProgram)(program);
    GLint good = 0;
    GL(PFNGLGETPROGRAMIVPROC, glGetProgramiv)(program, GL_LINK_STATUS, &good);
    if (good == 0) throw Refused(logOf(program, true));
    GL(PFNGLUSEPROGRAMPROC, glUseProgram)(program);
    return program;
}

struct Format {
    GLint internal;
    GLenum type;
};
Format formatOf(gpu::Number number) {
    switch (number) {
        case gpu::Number::float16:
            return {GL_RGBA16F, GL_HALF_FLOAT};
        case gpu::Number::float32:
            return {GL_RGBA32F, GL_FLOAT};
        case gpu::Number::unorm16:
            return {GL_RGBA16, GL_UNSIGNED_SHORT};
        case gpu::Number::unorm8:
            break;
    }
    return {GL_RGBA8, GL_UNSIGNED_BYTE};
}

GLuint newTexture(GLenum unit, GLenum target, GLint filter, Objects& objects) {
    GLuint texture = 0;
    GL(PFNGLGENTEXTURESPROC, glGenTextures)(1, &texture);
    objects.textures.push_back(texture);
    GL(PFNGLACTIVETEXTUREPROC, glActiveTexture)(GL_TEXTURE0 + unit);
    GL(PFNGLBINDTEXTUREPROC, glBindTexture)(target, texture);
    const auto set = GL(PFNGLTEXPARAMETERIPROC, glTexParameteri);
    set(target, GL_TEXTURE_MIN_FILTER, filter);
    set(target, GL_TEXTURE_MAG_FILTER, filter);
    set(target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    set(target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return texture;
}

GLenum targetOf(ComputeResource::Shape shape) {
    switch (shape) {
        case ComputeResource::Shape::flat:
            return GL_TEXTURE_2D;
        case ComputeResource::Shape::cube:
            return GL_TEXTURE_CUBE_MAP;
        case ComputeResource::Shape::array:
            break;
    }
    return GL_TEXTURE_2D_ARRAY;
}

void uploadLevel(ComputeResource::Shape shape, GLint level, const gpu::Texels& texels) {
    const auto [internal, type] = formatOf(texels.number);
    const int width = texels.width, height = texels.height;
    if (shape == ComputeResource::Shape::array) {
        GL(PFNGLTEXIMAGE3DPROC, glTexImage3D)
        (GL_TEXTURE_2D_ARRAY, level, internal, width, height, static_cast<GLsizei>(texels.layers),
         0, GL_RGBA, type, texels.bytes.data());
        return;
    }
    const bool cube = shape == ComputeResource::Shape::cube;
    const std::size_t size = texels.bytes.size() / texels.layers;
    for (std::size_t k = 0; k < texels.layers; ++k) {
        const GLenum target =
            cube ? GL_TEXTURE_CUBE_MAP_POSITIVE_X + static_cast<GLenum>(k) : GL_TEXTURE_2D;
        GL(PFNGLTEXIMAGE2DPROC, glTexImage2D)
        (target, level, internal, width, height, 0, GL_RGBA, type, texels.bytes.data() + k * size);
    }
}

void uploadTexture(const ComputeResource& resource, Objects& objects) {
    const GLenum target = targetOf(resource.shape);
    // Flat textures are tables, fetched without a filter.
    const bool table = resource.shape == ComputeResource::Shape::flat;
    newTexture(resource.binding, target, table ? GL_NEAREST : GL_LINEAR, objects);
    uploadLevel(resource.shape, 0, resource.texels);
    if (resource.levels.empty()) return;
    for (std::size_t k = 0; k < resource.levels.size(); ++k)
        uploadLevel(resource.shape, static_cast<GLint>(k) + 1, resource.levels[k]);
    const auto set = GL(PFNGLTEXPARAMETERIPROC, glTexParameteri);
    set(target, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    set(target, GL_TEXTURE_MAX_LEVEL, static_cast<GLint>(resource.levels.size()));
}

void uploadBuffer(GLenum target, const ComputeResource& resource, Objects& objects) {
    GLuint buffer = 0;
    GL(PFNGLGENBUFFERSPROC, glGenBuffers)(1, &buffer);
    objects.buffers.push_back(buffer);
    std::vector<float> numbers = resource.numbers;
    numbers.resize(std::max(numbers.size(), resource.count));
    GL(PFNGLBINDBUFFERPROC, glBindBuffer)(target, buffer);
    GL(PFNGLBUFFERDATAPROC, glBufferData)
    (target, static_cast<GLsizeiptr>(numbers.size() * 4), numbers.data(), GL_DYNAMIC_READ);
    GL(PFNGLBINDBUFFERBASEPROC, glBindBufferBase)(target, resource.binding, buffer);
}

void upload(const BoundShader& shader, GLuint program, Objects& objects) {
    for (const ComputeResource& resource : shader.resources) {
        switch (resource.kind) {
            case ComputeResource::Kind::sampledTexture:
                uploadTexture(resource, objects);
                break;
            case ComputeResource::Kind::uniforms: {
                uploadBuffer(GL_UNIFORM_BUFFER, resource, objects);
                const GLuint at =
                    GL(PFNGLGETUNIFORMBLOCKINDEXPROC, glGetUniformBlockIndex)(program, "hsh_Block");
                GL(PFNGLUNIFORMBLOCKBINDINGPROC, glUniformBlockBinding)
                (program, at, resource.binding);
                break;
            }
            case ComputeResource::Kind::buffer:
                uploadBuffer(GL_SHADER_STORAGE_BUFFER, resource, objects);
                if (resource.binding == 4) objects.output = objects.buffers.back();
                break;
            case ComputeResource::Kind::texture:
            case ComputeResource::Kind::sampler:
                throw std::invalid_argument("OpenGL has no textures apart from their samplers");
        }
    }
}

void checkErrors(const char* where) {
    const GLenum error = GL(PFNGLGETERRORPROC, glGetError)();
    if (error != GL_NO_ERROR)
        throw std::runtime_error(std::string(where) + ": OpenGL error " + std::to_string(error));
}

std::vector<float> compute(const BoundShader& shader) {
    Objects objects;
    addShader(GL_COMPUTE_SHADER, shader.program, objects);
    upload(shader, link(objects), objects);
    GL(PFNGLENABLEPROC, glEnable)(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    GL(PFNGLDISPATCHCOMPUTEPROC, glDispatchCompute)
    (static_cast<GLuint>(shader.invocations / 64), 1, 1);
    GL(PFNGLMEMORYBARRIERPROC, glMemoryBarrier)(GL_BUFFER_UPDATE_BARRIER_BIT);
    std::vector<float> outputs(shader.invocations * shader.outputs);
    GL(PFNGLBINDBUFFERPROC, glBindBuffer)(GL_SHADER_STORAGE_BUFFER, objects.output);
    GL(PFNGLGETBUFFERSUBDATAPROC, glGetBufferSubData)
    (GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(outputs.size() * 4), outputs.data());
    checkErrors("compute shader");
    return outputs;
}

/// Four float targets of a square, bound for drawing.
std::array<GLenum, 4> bindTargets(int side, Objects& objects) {
    GLuint frame = 0;
    GL(PFNGLGENFRAMEBUFFERSPROC, glGenFramebuffers)(1, &frame);
    objects.frames.push_back(frame);
    GL(PFNGLBINDFRAMEBUFFERPROC, glBindFramebuffer)(GL_FRAMEBUFFER, frame);
    std::array<GLenum, 4> targets{};
    for (GLenum k = 0; k < 4; ++k) {
        targets[k] = GL_COLOR_ATTACHMENT0 + k;
        const GLuint texture = newTexture(unitOfTargets, GL_TEXTURE_2D, GL_NEAREST, objects);
        GL(PFNGLTEXIMAGE2DPROC, glTexImage2D)
        (GL_TEXTURE_2D, 0, GL_RGBA32F, side, side, 0, GL_RGBA, GL_FLOAT, nullptr);
        GL(PFNGLFRAMEBUFFERTEXTURE2DPROC, glFramebufferTexture2D)
        (GL_FRAMEBUFFER, targets[k], GL_TEXTURE_2D, texture, 0);
    }
    GL(PFNGLDRAWBUFFERSPROC, glDrawBuffers)(4, targets.data());
    if (GL(PFNGLCHECKFRAMEBUFFERSTATUSPROC, glCheckFramebufferStatus)(GL_FRAMEBUFFER) !=
        GL_FRAMEBUFFER_COMPLETE)
        throw Missing("OpenGL ES renders into no float targets");
    GL(PFNGLVIEWPORTPROC, glViewport)(0, 0, side, side);
    return targets;
}

std::vector<float> draw(const BoundShader& shader) {
    const int side = static_cast<int>(std::lround(std::sqrt(shader.invocations)));
    Objects objects;
    addShader(GL_VERTEX_SHADER,
              "#version 300 es\nvoid main() { gl_Position = vec4(float(gl_VertexID % 2) * 4.0 - "
              "1.0, float(gl_VertexID / 2) * 4.0 - 1.0, 0.0, 1.0); }\n",
              objects);
    addShader(GL_FRAGMENT_SHADER, shader.program, objects);
    const GLuint program = link(objects);
    upload(shader, program, objects);
    for (const auto& [name, unit] : esSamplers) {
        const GLint at = GL(PFNGLGETUNIFORMLOCATIONPROC, glGetUniformLocation)(program, name);
        if (at >= 0) GL(PFNGLUNIFORM1IPROC, glUniform1i)(at, unit);
    }
    const std::array<GLenum, 4> targets = bindTargets(side, objects);
    GL(PFNGLDRAWARRAYSPROC, glDrawArrays)(GL_TRIANGLES, 0, 3);
    std::vector<float> outputs(shader.invocations * shader.outputs), pixels(shader.invocations * 4);
    for (std::size_t k = 0; k < 4; ++k) {
        GL(PFNGLREADBUFFERPROC, glReadBuffer)(targets[k]);
        GL(PFNGLREADPIXELSPROC, glReadPixels)(0, 0, side, side, GL_RGBA, GL_FLOAT, pixels.data());
        for (std::size_t p = 0; p < shader.invocations; ++p)
            for (std::size_t i = 4 * k; i < std::min(4 * k + 4, shader.outputs); ++i)
                outputs[p * shader.outputs + i] = pixels[p * 4 + i - 4 * k];
    }
    checkErrors("fragment shader");
    return outputs;
}

bool has(const char* words, std::string_view word) {
    return words != nullptr && std::string_view(words).find(word) != std::string_view::npos;
}

/// The displays that need no window: the displays of devices, GPUs first, and Mesa's display for
/// its renderer in software.
std::vector<EGLDisplay> displays(Choice kind) {
    const auto getDisplay = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
        eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (getDisplay == nullptr) throw Missing("EGL has no platform displays");
    std::vector<EGLDisplay> found;
    const auto queryDevices =
        reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
    const auto queryText = reinterpret_cast<PFNEGLQUERYDEVICESTRINGEXTPROC>(
        eglGetProcAddress("eglQueryDeviceStringEXT"));
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    if (kind != Choice::software && queryDevices != nullptr && queryText != nullptr &&
        queryDevices(static_cast<EGLint>(devices.size()), devices.data(), &count) != EGL_FALSE) {
        for (EGLint k = 0; k < count; ++k) {
            const EGLDeviceEXT device = devices[static_cast<std::size_t>(k)];
            if (!has(queryText(device, EGL_EXTENSIONS), "EGL_MESA_device_software"))
                found.push_back(getDisplay(EGL_PLATFORM_DEVICE_EXT, device, nullptr));
        }
    }
    if (kind != Choice::gpu)
        found.push_back(getDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    return found;
}

}  // namespace

struct GlContext::Parts {
    Api api;
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
    std::string renderer = {};
    bool software = false;

    Parts(Api of, Choice kind) : api(of) {
        for (const EGLDisplay one : displays(kind))
            if (open(one, kind)) return;
        const std::string name(apiName(api));
        throw Missing(kind == Choice::gpu ? "no GPU with " + name + " through EGL"
                                          : "no " + name +
                                                " through EGL (libegl1, "
                                                "libgl1-mesa-dri)");
    }
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;
    ~Parts() { close(); }

    void makeCurrent() const {
        if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_FALSE)
            throw std::runtime_error("EGL: the context is lost");
    }

private:
    bool open(EGLDisplay one, Choice kind) {
        EGLint major = 0, minor = 0;
        if (one == EGL_NO_DISPLAY || eglInitialize(one, &major, &minor) == EGL_FALSE) return false;
        display = one;
        const bool es = api == Api::openGlEs;
        eglBindAPI(es ? EGL_OPENGL_ES_API : EGL_OPENGL_API);
        const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE,
                                 es ? EGL_OPENGL_ES3_BIT : EGL_OPENGL_BIT, EGL_NONE};
        EGLConfig config = nullptr;
        EGLint count = 0;
        eglChooseConfig(display, wanted, &config, 1, &count);
        const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, es ? 3 : 4, EGL_CONTEXT_MINOR_VERSION,
                                  es ? 0 : 5, EGL_NONE};
        if (count > 0) context = eglCreateContext(display, config, EGL_NO_CONTEXT, version);
        if (context != EGL_NO_CONTEXT &&
            eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) != EGL_FALSE) {
            renderer =
                reinterpret_cast<const char*>(GL(PFNGLGETSTRINGPROC, glGetString)(GL_RENDERER));
            software = has(renderer.c_str(), "llvmpipe") || has(renderer.c_str(), "softpipe");
            if (!software || kind != Choice::gpu) return true;
        }
        close();
        return false;
    }
    void close() {
        if (display == EGL_NO_DISPLAY) return;
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
        eglTerminate(display);
        display = EGL_NO_DISPLAY;
        context = EGL_NO_CONTEXT;
    }
};

GlContext::GlContext(Api api, Choice kind) : parts_(std::make_unique<Parts>(api, kind)) {}
GlContext::~GlContext() = default;
const std::string& GlContext::renderer() const {
    return parts_->renderer;
}
bool GlContext::software() const {
    return parts_->software;
}
std::vector<float> GlContext::run(const BoundShader& shader) const {
    parts_->makeCurrent();
    return parts_->api == Api::openGlEs ? draw(shader) : compute(shader);
}

}  // namespace hshfit::shaders
