#!/usr/bin/env bash
# Bring the libraries of report.html up to date: docs/make/report_libraries.sh [THREE [UPLOT]] (versions; needs npm).
# three.js is bundled with just the parts that the report uses; both are MIT, their licences lie beside them.
set -euo pipefail
three=${1:-0.187.0} uplot=${2:-1.6.32}
target=$(cd "$(dirname "$0")/../.." && pwd)/src/abut/report/static
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm init -y >/dev/null
npm install --silent "three@$three" "uplot@$uplot" esbuild
cat >parts.js <<'END'
export {
  BufferAttribute, BufferGeometry, Color, DataTexture, DoubleSide, LinearFilter, LineSegments, Mesh, OrthographicCamera,
  PerspectiveCamera, Raycaster, Scene, ShaderMaterial, Vector2, Vector3, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
END
npx esbuild parts.js --bundle --minify --format=iife --global-name=THREE --legal-comments=none --outfile="$target/three.min.js" \
  --banner:js="/* three.js $three, MIT licence, https://threejs.org: the parts that abut's report uses */"
cp node_modules/uplot/dist/uPlot.iife.min.js "$target/uplot.min.js"
cp node_modules/uplot/dist/uPlot.min.css "$target/uplot.min.css"
cp node_modules/three/LICENSE "$target/LICENSE-three.txt"
cp node_modules/uplot/LICENSE "$target/LICENSE-uplot.txt"
