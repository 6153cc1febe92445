// Makes the page without data: node make_page.mjs NODE_MODULES PAGE. The scripts are bundled by esbuild and compressed; the page
// expands them when it is opened. @TITLE@ and @RUNS@ are the places of what view_page.cpp puts in.
import { readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { deflateSync } from 'node:zlib';

const [modules, page] = process.argv.slice(2).map((path) => resolve(path));
const here = dirname(fileURLToPath(import.meta.url));
const esbuild = createRequire(join(modules, 'x.js'))('esbuild');

const bundle = esbuild.buildSync({
  entryPoints: [join(here, 'src', 'main.js')], nodePaths: [modules], bundle: true, minify: true, format: 'iife',
  target: 'es2022', legalComments: 'none', charset: 'ascii', write: false,
}).outputFiles[0].contents;
const style = readFileSync(join(modules, 'uplot', 'dist', 'uPlot.min.css'), 'utf8') + readFileSync(join(here, 'src', 'style.css'), 'utf8');
const licences = ['three', 'uplot'].map((name) => `${name}\n${readFileSync(join(modules, name, 'LICENSE'), 'utf8')}`).join('\n');

const parts = { STYLE: style, LICENCES: licences.replaceAll('--', '- -'), BUNDLE: deflateSync(bundle, { level: 9 }).toString('base64') };
const template = readFileSync(join(here, 'page.html'), 'utf8');
writeFileSync(page, template.replace(/@(STYLE|LICENCES|BUNDLE)@/g, (_, name) => parts[name]));
