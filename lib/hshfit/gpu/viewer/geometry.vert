#version 300 es
// Position and normal in world space; the camera does not move the light.
uniform mat4 camera;
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
out vec3 worldPosition, worldNormal;
void main() {
    worldPosition = position;
    worldNormal = normal;
    gl_Position = camera * vec4(position, 1.0);
}
