% Tables of a run folder of vbar in Octave and MATLAB: run = vbar_run ("runs/experiment3-1"); run.truth.time_s
% Each table is a struct of columns: a number column is a vector (an empty cell NaN), a column of words a cell array.
function run = vbar_run (folder)
  files = dir (fullfile (folder, "*.csv"));
  if isempty (files)
    error ("vbar_run: %s has no tables", folder);
  end
  run = struct ();
  for k = 1:numel (files)
    name = files(k).name(1:end - 4);
    run.(name) = read_table (fullfile (folder, files(k).name));
  end
end

function table = read_table (file)
  lines = strsplit (fileread (file), "\n");
  lines = lines(~cellfun (@isempty, lines));
  names = strsplit (lines{1}, ",");
  cells = cell (numel (lines) - 1, numel (names));
  for row = 2:numel (lines)
    parts = cells_of (lines{row});
    cells(row - 1, 1:numel (parts)) = parts;
  end
  table = struct ();
  for column = 1:numel (names)
    words = cells(:, column);
    numbers = str2double (words);
    is_number = all (cellfun (@isempty, words) | ~isnan (numbers) | strcmp (words, "nan"));
    if is_number
      table.(names{column}) = numbers;
    else
      table.(names{column}) = words;
    end
  end
end

% The cells of a line; one between quotation marks may hold commas.
function parts = cells_of (line)
  inside = mod (cumsum (line == '"'), 2) == 1;
  ends = [find(line == ',' & ~inside), numel(line) + 1];
  parts = cell (1, numel (ends));
  start = 1;
  for k = 1:numel (ends)
    parts{k} = strrep (line(start:ends(k) - 1), '"', "");
    start = ends(k) + 1;
  end
end
