// Compiles a Kaitai Struct description to Python: node compile_ksy.js IN.ksy OUT.py
// (npm install kaitai-struct-compiler js-yaml)
const fs = require("fs");
const path = require("path");
const crypto = require("crypto");
const { createRequire } = require("module");

// the packages lie where the command is run, not beside this file
const load = createRequire(path.join(process.cwd(), "package.json"));
const compiler = load("kaitai-struct-compiler");
const yaml = load("js-yaml");

const [input, output] = process.argv.slice(2);
const text = fs.readFileSync(input, "utf8");
const hash = crypto.createHash("sha256").update(text).digest("hex");
compiler.compile("python", yaml.load(text), null, false).then(
  (files) => fs.writeFileSync(output, `# ksy sha256 ${hash}\n` + Object.values(files)[0]),
  (error) => {
    console.error(`compile_ksy: ${error}`);
    process.exit(1);
  },
);
