// The sea bed as a block, drawn pixel by pixel with a depth buffer; kept until the camera moves.

const TABLE_SIZE = 2048, LOWEST = -20;

/** A lit colour as the screen stores it. */
function pixel(red, green, blue, light) {
  return (255 << 24 | Math.min(255, blue * light) << 16 | Math.min(255, green * light) << 8 | Math.min(255, red * light)) >>> 0;
}

class Terrain {
  constructor(bed) {
    const n = bed.n;
    this.n = n;
    this.canvas = document.createElement("canvas");
    this.depths = Float32Array.from(bed.v);
    // Four rows of the block's lower rim follow the grid.
    const rim = [k => k, k => (n - 1) * n + k, k => k * n, k => k * n + n - 1];
    const count = n * n + 4 * n;
    [this.x, this.y, this.away, this.shade] = Array.from({ length: 4 }, () => new Float32Array(count));
    const walls = [];
    rim.forEach((upper, side) => {
      for (let k = 0; k + 1 < n; k++) {
        const lower = n * n + side * n + k;
        walls.push(upper(k), upper(k + 1), lower, upper(k + 1), lower + 1, lower);
      }
    });
    this.rim = rim;
    this.dEast = (EAST1 - EAST0) / (n - 1);
    this.dNorth = (NORTH1 - NORTH0) / (n - 1);
    const v = this.depths, inside = k => Math.max(0, Math.min(n - 1, k));
    this.slopeEast = v.map((_, k) => (v[k - k % n + inside(k % n + 1)] - v[k - k % n + inside(k % n - 1)]) / (2 * this.dEast));
    this.slopeNorth = v.map((_, k) => (v[inside(Math.floor(k / n) + 1) * n + k % n] - v[inside(Math.floor(k / n) - 1) * n + k % n]) / (2 * this.dNorth));
    this.whole = this.mesh(1);
    this.coarse = (n - 1) % 2 === 0 ? this.mesh(2) : this.whole;
    this.moved = -Infinity;
    this.walls = Uint32Array.from(walls);
    this.colours = new Float32Array(3 * TABLE_SIZE);
    this.perMetre = (TABLE_SIZE - 1) / (DEEPEST - LOWEST);
    for (let k = 0; k < TABLE_SIZE; k++) this.colours.set(bedColour(LOWEST + k / this.perMetre), 3 * k);
  }

  /** Corners of the triangles between every `step`-th depth. */
  mesh(step) {
    const { n } = this, corners = [], down = step * n;
    for (let j = 0; j + step < n; j += step) for (let i = 0; i + step < n; i += step) {
      const k = j * n + i;
      corners.push(k, k + step, k + down, k + step, k + down + step, k + down);
    }
    return Uint32Array.from(corners);
  }

  /** Whether the camera is on the move; when it comes to rest the picture is asked for once more. */
  moving() {
    const now = performance.now(), moving = now - this.moved < 250;
    this.moved = now;
    clearTimeout(this.rest);
    if (moving) this.rest = setTimeout(() => { this.key = null; redraw(); }, 300);
    return moving;
  }

  /** The picture for a camera; the same as before if the camera stood still, coarser while it moves. */
  draw(camera) {
    if (this.key === camera.key) return this.canvas;
    this.key = camera.key;
    const dots = camera.width * camera.height;
    this.fine = Math.min(window.devicePixelRatio || 1, Math.sqrt(8e5 / dots));
    const w = this.w = Math.max(1, Math.round(camera.width * this.fine)), h = this.h = Math.max(1, Math.round(camera.height * this.fine));
    if (this.canvas.width !== w || this.canvas.height !== h || !this.nearest) {
      this.canvas.width = w;
      this.canvas.height = h;
      this.image = this.canvas.getContext("2d").createImageData(w, h);
      this.pixels = new Uint32Array(this.image.data.buffer);
      this.nearest = new Float32Array(w * h);
    }
    this.pixels.fill(0);
    this.nearest.fill(Infinity);
    this.place(camera);
    this.fill(this.moving() ? this.coarse : this.whole, true);
    if (camera.solid) this.fill(this.walls, false);
    this.canvas.getContext("2d").putImageData(this.image, 0, 0);
    return this.canvas;
  }

  /** Projects and shades all corners. */
  place(camera) {
    const { n, dEast, dNorth } = this;
    const put = (k, i, j, depth) => {
      const [x, y, away] = camera.project([EAST0 + i * dEast, NORTH0 + j * dNorth, depth]);
      this.x[k] = x * this.fine;
      this.y[k] = y * this.fine;
      this.away[k] = away;
    };
    // Light from the upper left of the picture.
    const { cosA, sinA, times } = camera, east = (-.6 * cosA + .4 * sinA) * times, north = (.6 * sinA + .4 * cosA) * times;
    for (let j = 0; j < n; j++) for (let i = 0; i < n; i++) {
      const k = j * n + i, slopeEast = this.slopeEast[k], slopeNorth = this.slopeNorth[k];
      put(k, i, j, this.depths[k]);
      const steep = Math.sqrt(times * times * (slopeEast * slopeEast + slopeNorth * slopeNorth) + 1);
      this.shade[k] = Math.max(.55, Math.min(1.06, .55 + .45 * (slopeEast * east + slopeNorth * north + 1) / steep));
    }
    this.rim.forEach((upper, side) => {
      for (let k = 0; k < n; k++) {
        const at = upper(k), lower = n * n + side * n + k;
        put(lower, at % n, Math.floor(at / n), BASE);
        this.shade[lower] = .8;
      }
    });
  }

  fill(corners, bed) {
    const { x, y, away, shade, depths, colours, w, h, pixels, nearest } = this;
    for (let t = 0; t < corners.length; t += 3) {
      const a = corners[t], b = corners[t + 1], c = corners[t + 2];
      const low = Math.max(0, Math.ceil(Math.min(y[a], y[b], y[c]))), high = Math.min(h - 1, Math.floor(Math.max(y[a], y[b], y[c])));
      if (low > high || Math.max(x[a], x[b], x[c]) < 0 || Math.min(x[a], x[b], x[c]) > w) continue;
      const bx = x[b] - x[a], by = y[b] - y[a], cx = x[c] - x[a], cy = y[c] - y[a], area = bx * cy - by * cx;
      if (area === 0) continue;
      // What rises evenly over the triangle: per pixel to the right and down.
      const right1 = cy / area, right2 = -by / area, down1 = -cx / area, down2 = bx / area;
      const away1 = away[b] - away[a], away2 = away[c] - away[a], awayX = away1 * right1 + away2 * right2, awayY = away1 * down1 + away2 * down2;
      const shade1 = shade[b] - shade[a], shade2 = shade[c] - shade[a], shadeX = shade1 * right1 + shade2 * right2, shadeY = shade1 * down1 + shade2 * down2;
      const depth1 = bed ? depths[b] - depths[a] : 0, depth2 = bed ? depths[c] - depths[a] : 0, depthX = depth1 * right1 + depth2 * right2, depthY = depth1 * down1 + depth2 * down2;
      for (let row = low; row <= high; row++) {
        let from = Infinity, to = -Infinity;
        for (let side = 0; side < 3; side++) {
          const p = side === 0 ? a : side === 1 ? b : c, q = side === 0 ? b : side === 1 ? c : a;
          if ((y[p] <= row) === (y[q] <= row)) continue;
          const cross = x[p] + (row - y[p]) * (x[q] - x[p]) / (y[q] - y[p]);
          if (cross < from) from = cross;
          if (cross > to) to = cross;
        }
        const last = Math.min(w - 1, Math.floor(to + .01)), dy = row - y[a];
        for (let column = Math.max(0, Math.ceil(from - .01)); column <= last; column++) {
          const dx = column - x[a], k = row * w + column, far = away[a] + awayX * dx + awayY * dy;
          if (far >= nearest[k]) continue;
          nearest[k] = far;
          const light = shade[a] + shadeX * dx + shadeY * dy;
          if (bed) {
            const depth = depths[a] + depthX * dx + depthY * dy;
            const o = depth <= SHORE ? 0 : 3 * Math.min(TABLE_SIZE - 1, Math.round((depth - LOWEST) * this.perMetre));
            pixels[k] = pixel(colours[o], colours[o + 1], colours[o + 2], light);
          } else pixels[k] = pixel(196, 188, 174, light);
        }
      }
    }
  }

  /** Whether the sea bed stands before a projected place; `slack` in metres. */
  hides(p, slack) {
    const column = Math.round(p[0] * this.fine), row = Math.round(p[1] * this.fine);
    return column >= 0 && row >= 0 && column < this.w && row < this.h && p[2] > this.nearest[row * this.w + column] + slack;
  }
}
