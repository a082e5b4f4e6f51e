#include "runners.h"

#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <algorithm>
#include <array>

namespace hshfit::shaders {
namespace {

/// A context without a surface on Mesa's software renderer; current while it lives.
class Context {
public:
    explicit Context(bool es) {
        const auto getDisplay = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
            eglGetProcAddress("eglGetPlatformDisplayEXT"));
        if (getDisplay == nullptr) throw Missing("EGL has no platform displays");
        display_ = getDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
        EGLint major = 0, minor = 0;
        if (eglInitialize(display_, &major, &minor) == EGL_FALSE)
            throw Missing("no EGL display without a surface (libegl1, libgl1-mesa-dri)");
        eglBindAPI(es ? EGL_OPENGL_ES_API : EGL_OPENGL_API);
        const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE,
                                 es ? EGL_OPENGL_ES3_BIT : EGL_OPENGL_BIT, EGL_NONE};
        EGLConfig config = nullptr;
        EGLint count = 0;
        eglChooseConfig(display_, wanted, &config, 1, &count);
        const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, es ? 3 : 4, EGL_CONTEXT_MINOR_VERSION,
                                  es ? 0 : 5, EGL_NONE};
        context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, version);
        if (count == 0 || context_ == EGL_NO_CONTEXT ||
            eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE) {
            eglTerminate(display_);
            throw Missing(es ? "no OpenGL ES 3 through EGL" : "no OpenGL 4.5 through EGL");
        }
    }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    ~Context() {
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display_, context_);
        eglTerminate(display_);
    }

private:
    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
};

/// An OpenGL function by its name; `Type` is its PFN…PROC.
template <class Type>
Type function(const char* name) {
    const auto found = reinterpret_cast<Type>(eglGetProcAddress(name));
    if (found == nullptr) throw Missing(std::string("OpenGL lacks ") + name);
    return found;
}
#define GL(type, name) function<type>(#name)

std::string logOf(GLuint object, bool program) {
    std::array<char, 4096> text{};
    if (program)
        GL(PFNGLGETPROGRAMINFOLOGPROC, glGetProgramInfoLog)(object, 4095, nullptr, text.data());
    else
        GL(PFNGLGETSHADERINFOLOGPROC, glGetShaderInfoLog)(object, 4095, nullptr, text.data());
    return text.data();
}

GLuint compile(GLenum stage, const std::string& source) {
    const GLuint shader = GL(PFNGLCREATESHADERPROC, glCreateShader)(stage);
    const char* text = source.c_str();
    GL(PFNGLSHADERSOURCEPROC, glShaderSource)(shader, 1, &text, nullptr);
    GL(PFNGLCOMPILESHADERPROC, glCompileShader)(shader);
    GLint good = 0;
    GL(PFNGLGETSHADERIVPROC, glGetShaderiv)(shader, GL_COMPILE_STATUS, &good);
    if (good == 0) throw Refused(logOf(shader, false));
    return shader;
}

GLuint link(const std::vector<GLuint>& shaders) {
    const GLuint program = GL(PFNGLCREATEPROGRAMPROC, glCreateProgram)();
    for (const GLuint shader : shaders) GL(PFNGLATTACHSHADERPROC, glAttachShader)(program, shader);
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

GLuint newTexture(GLenum unit, GLenum target, GLint filter) {
    GLuint texture = 0;
    GL(PFNGLGENTEXTURESPROC, glGenTextures)(1, &texture);
    GL(PFNGLACTIVETEXTUREPROC, glActiveTexture)(GL_TEXTURE0 + unit);
    GL(PFNGLBINDTEXTUREPROC, glBindTexture)(target, texture);
    const auto set = GL(PFNGLTEXPARAMETERIPROC, glTexParameteri);
    set(target, GL_TEXTURE_MIN_FILTER, filter);
    set(target, GL_TEXTURE_MAG_FILTER, filter);
    set(target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    set(target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return texture;
}

void upload(GLenum unit, const gpu::Texels& first, const std::vector<gpu::Texels>& levels = {}) {
    newTexture(unit, GL_TEXTURE_2D_ARRAY, GL_LINEAR);
    const auto [internal, type] = formatOf(first.number);
    std::vector<const gpu::Texels*> all{&first};
    for (const gpu::Texels& level : levels) all.push_back(&level);
    for (std::size_t k = 0; k < all.size(); ++k) {
        GL(PFNGLTEXIMAGE3DPROC, glTexImage3D)
        (GL_TEXTURE_2D_ARRAY, static_cast<GLint>(k), internal, all[k]->width, all[k]->height,
         static_cast<GLsizei>(all[k]->layers), 0, GL_RGBA, type, all[k]->bytes.data());
    }
    if (levels.empty()) return;
    const auto set = GL(PFNGLTEXPARAMETERIPROC, glTexParameteri);
    set(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    set(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAX_LEVEL, static_cast<GLint>(levels.size()));
}

void uploadHarmonics(GLenum unit, const ShaderJob& job) {
    if (job.harmonics.empty()) return;
    upload(unit, job.harmonics[0], {job.harmonics.begin() + 1, job.harmonics.end()});
}

/// A 2-D texture of numbers, 3 or 1 of them a texel, to be fetched exactly.
void uploadNumbers(GLenum unit, int width, int height, const std::vector<float>& numbers) {
    newTexture(unit, GL_TEXTURE_2D, GL_NEAREST);
    const bool vectors = numbers.size() == static_cast<std::size_t>(3 * width * height);
    GL(PFNGLTEXIMAGE2DPROC, glTexImage2D)
    (GL_TEXTURE_2D, 0, vectors ? GL_RGB32F : GL_R32F, width, height, 0, vectors ? GL_RGB : GL_RED,
     GL_FLOAT, numbers.data());
}

void setSampler(GLuint program, const char* name, GLint unit) {
    const GLint at = GL(PFNGLGETUNIFORMLOCATIONPROC, glGetUniformLocation)(program, name);
    if (at >= 0) GL(PFNGLUNIFORM1IPROC, glUniform1i)(at, unit);
}

void checkErrors(const char* where) {
    const GLenum error = GL(PFNGLGETERRORPROC, glGetError)();
    if (error != GL_NO_ERROR)
        throw std::runtime_error(std::string(where) + ": OpenGL error " + std::to_string(error));
}

GLuint storage(GLuint binding, std::size_t bytes, const void* data) {
    GLuint buffer = 0;
    GL(PFNGLGENBUFFERSPROC, glGenBuffers)(1, &buffer);
    GL(PFNGLBINDBUFFERPROC, glBindBuffer)(GL_SHADER_STORAGE_BUFFER, buffer);
    GL(PFNGLBUFFERDATAPROC, glBufferData)
    (GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(bytes), data, GL_DYNAMIC_READ);
    GL(PFNGLBINDBUFFERBASEPROC, glBindBufferBase)(GL_SHADER_STORAGE_BUFFER, binding, buffer);
    return buffer;
}

/// The uniform block of a form, if it has one, at binding 0.
void uploadBlock(GLuint program, const ShaderJob& job) {
    const std::vector<float> numbers = blockNumbers(job);
    if (numbers.empty()) return;
    GLuint buffer = 0;
    GL(PFNGLGENBUFFERSPROC, glGenBuffers)(1, &buffer);
    GL(PFNGLBINDBUFFERPROC, glBindBuffer)(GL_UNIFORM_BUFFER, buffer);
    GL(PFNGLBUFFERDATAPROC, glBufferData)
    (GL_UNIFORM_BUFFER, static_cast<GLsizeiptr>(numbers.size() * 4), numbers.data(),
     GL_STATIC_DRAW);
    GL(PFNGLBINDBUFFERBASEPROC, glBindBufferBase)(GL_UNIFORM_BUFFER, 0, buffer);
    const GLuint at =
        GL(PFNGLGETUNIFORMBLOCKINDEXPROC, glGetUniformBlockIndex)(program, "hsh_Block");
    GL(PFNGLUNIFORMBLOCKBINDINGPROC, glUniformBlockBinding)(program, at, 0);
}

std::vector<float> components(const std::vector<Direction>& directions) {
    std::vector<float> result;
    for (const Direction& d : directions)
        for (const double v : {d.x, d.y, d.z}) result.push_back(static_cast<float>(v));
    return result;
}

}  // namespace

std::vector<float> runOpenGl(const ShaderJob& job, const std::string& source) {
    const Context context(false);
    uploadBlock(link({compile(GL_COMPUTE_SHADER, source)}), job);
    upload(0, job.payload.coefficients, job.levels);
    if (job.payload.basisTexels) upload(2, *job.payload.basisTexels);
    uploadHarmonics(5, job);
    const std::vector<float> inputs = inputNumbers(job);
    std::vector<float> outputs(job.pairs.wo.size() * job.outputs());
    storage(3, inputs.size() * 4, inputs.data());
    storage(4, outputs.size() * 4, nullptr);
    GL(PFNGLDISPATCHCOMPUTEPROC, glDispatchCompute)
    (static_cast<GLuint>(job.pairs.wo.size() / 64), 1, 1);
    GL(PFNGLMEMORYBARRIERPROC, glMemoryBarrier)(GL_BUFFER_UPDATE_BARRIER_BIT);
    GL(PFNGLGETBUFFERSUBDATAPROC, glGetBufferSubData)
    (GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(outputs.size() * 4), outputs.data());
    checkErrors("compute shader");
    return outputs;
}

std::vector<float> runOpenGlEs(const ShaderJob& job, const std::string& source) {
    constexpr int side = Pairs::side;
    const Context context(true);
    const std::string corners =
        "#version 300 es\nvoid main() { gl_Position = vec4(float(gl_VertexID % 2) * 4.0 - 1.0, "
        "float(gl_VertexID / 2) * 4.0 - 1.0, 0.0, 1.0); }\n";
    const GLuint program =
        link({compile(GL_VERTEX_SHADER, corners), compile(GL_FRAGMENT_SHADER, source)});
    upload(0, job.payload.coefficients, job.levels);
    uploadBlock(program, job);
    setSampler(program, job.places.empty() ? "hsh_coefficients" : "hsh_map", 0);
    if (job.payload.basisTexels) upload(1, *job.payload.basisTexels);
    setSampler(program, job.places.empty() ? "hsh_basis" : "hsh_shared", 1);
    uploadNumbers(2, side, side, components(job.pairs.wo));
    setSampler(program, "wos", 2);
    uploadNumbers(3, side, side, components(job.pairs.wi));
    setSampler(program, "wis", 3);
    const int slots = job.environment.order * job.environment.order;
    std::vector<float> lights;
    for (std::size_t i = 0; i < job.lights(); ++i)
        for (std::size_t j = 0; j < static_cast<std::size_t>(slots); ++j)
            lights.push_back(static_cast<float>(job.environment.values[j * job.lights() + i]));
    if (!lights.empty()) uploadNumbers(4, slots, static_cast<int>(job.lights()), lights);
    setSampler(program, "lights", 4);
    const std::vector<float> places(job.places.begin(), job.places.end());
    if (!places.empty()) uploadNumbers(6, side, side, places);
    setSampler(program, "places", 6);
    uploadHarmonics(7, job);
    setSampler(program, "hsh_harmonics", 7);

    GLuint frame = 0;
    GL(PFNGLGENFRAMEBUFFERSPROC, glGenFramebuffers)(1, &frame);
    GL(PFNGLBINDFRAMEBUFFERPROC, glBindFramebuffer)(GL_FRAMEBUFFER, frame);
    std::array<GLenum, 4> targets{};
    for (GLenum k = 0; k < 4; ++k) {
        targets[k] = GL_COLOR_ATTACHMENT0 + k;
        const GLuint texture = newTexture(5, GL_TEXTURE_2D, GL_NEAREST);
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
    GL(PFNGLDRAWARRAYSPROC, glDrawArrays)(GL_TRIANGLES, 0, 3);
    std::vector<float> outputs(side * side * job.outputs()), pixels(side * side * 4);
    for (std::size_t k = 0; k < 4; ++k) {
        GL(PFNGLREADBUFFERPROC, glReadBuffer)(targets[k]);
        GL(PFNGLREADPIXELSPROC, glReadPixels)(0, 0, side, side, GL_RGBA, GL_FLOAT, pixels.data());
        for (std::size_t p = 0; p < side * side; ++p)
            for (std::size_t i = 4 * k; i < std::min(4 * k + 4, job.outputs()); ++i)
                outputs[p * job.outputs() + i] = pixels[p * 4 + i - 4 * k];
    }
    checkErrors("fragment shader");
    return outputs;
}

}  // namespace hshfit::shaders
