// Functions for every page that browser.mjs opens.
globalThis.checks = {
  bytesOf: (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)),
  floatsOf: (text) => new Float32Array(checks.bytesOf(text).buffer),

  // A program in use whose fragment shader sees the whole target, one triangle of three vertices
  // without attributes.
  useProgram(gl, fragment) {
    const vertex = `#version 300 es
      void main() {
        gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1);
      }`;
    const program = gl.createProgram();
    for (const [type, source] of [
      [gl.VERTEX_SHADER, vertex],
      [gl.FRAGMENT_SHADER, fragment],
    ]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
        throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS))
      throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    return program;
  },
};
